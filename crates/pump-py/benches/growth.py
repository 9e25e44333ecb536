"""How cost grows: curves over samples, rollers, volume, doses on record and points of a sweep.

`python benches/growth.py DOSE` writes docs/growth.md and its pictures. DOSE is the command for release.
A time is the shortest of several; a peak of memory is that of a process of its own, with its start.
"""

import math
import os
import re
import subprocess
import sys
import tempfile
import textwrap
import time
import warnings
import zlib
from collections.abc import Callable, Iterator
from concurrent.futures import Executor
from dataclasses import dataclass
from pathlib import Path

import matplotlib as mpl
import numpy as np
from dask.distributed import Client
from matplotlib import pyplot as plt

import pumpmodel as pm

mpl.use("Agg")

DOCS = Path(__file__).parents[3] / "docs"
PUMP = pm.Pump.three_roller()
RPM = 100.0
# Speeds of a row of a sweep, and points of a part.
SPEEDS = 1000
PART = 100_000

Curve = list[tuple[float, float]]


@dataclass
class Section:
    """A section of the page: its words, and a picture of curves with what they are drawn over."""

    title: str
    words: str
    over: str
    unit: str
    curves: dict[str, Curve]
    memory_mb: Curve | None = None

    def name(self) -> str:
        """Return the name of the picture."""
        return self.title.lower().split(" ")[0]

    def table(self) -> str:
        """Return the numbers of the curves."""
        columns = {f"{name}, {self.unit}": curve for name, curve in self.curves.items()}
        if self.memory_mb:
            columns["peak memory, MB"] = self.memory_mb
        over = sorted({x for curve in columns.values() for x, _ in curve})
        lines = [[self.over, *columns], ["---"] * (len(columns) + 1)]
        for x in over:
            cells = [dict(curve).get(x) for curve in columns.values()]
            lines.append([f"{x:,.10g}", *("" if cell is None else f"{cell:.3g}" for cell in cells)])
        return "\n".join("| " + " | ".join(cells) + " |" for cells in lines)

    def draw(self) -> None:
        """Write the picture, for a light page and for a dark one."""
        for ending, style in {"": "default", "_dark": "dark_background"}.items():
            with plt.style.context(style), mpl.rc_context({"svg.fonttype": "none", "svg.hashsalt": "growth"}):
                figure, axes = plt.subplots(figsize=(7, 3.2), layout="constrained")
                for label, curve in self.curves.items():
                    axes.plot(*zip(*curve, strict=True), ".-", label=label)
                spread = max(x for curve in self.curves.values() for x, _ in curve) > 100
                axes.set(
                    xscale="log" if spread else "linear", yscale="log", xlabel=self.over, ylabel=self.unit
                )
                axes.grid(alpha=0.3)
                axes.legend()
                path = DOCS / "growth" / f"{self.name()}{ending}.svg"
                figure.savefig(path, transparent=True, metadata={"Date": None})
                plt.close(figure)

    def markdown(self) -> str:
        """Return the section as the page has it."""
        alt = f"{', '.join(self.curves)} over {self.over}, {self.unit}"
        return f"""## {self.title}

{self.words}

<picture>
<source media="(prefers-color-scheme: dark)" srcset="growth/{self.name()}_dark.svg">
<img src="growth/{self.name()}.svg" alt="{alt}">
</picture>

{self.table()}
"""


def shortest(call: Callable[[], object], least: int = 3, fill_s: float = 0.3) -> float:
    """Return the shortest time of several, s: of `least` at least, and of as many as fill a time."""
    best, began, made = float("inf"), time.perf_counter(), 0
    while made < least or time.perf_counter() - began < fill_s:
        before = time.perf_counter()
        call()
        best, made = min(best, time.perf_counter() - before), made + 1
    return best


# A process counts the memory of the one that started it, so a small one starts what is measured.
STARTER = """
import resource, subprocess, sys, time
began = time.perf_counter()
code = subprocess.run(sys.argv[1:], stdout=subprocess.DEVNULL).returncode
print(time.perf_counter() - began, resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)
sys.exit(code)
"""


def measured(words: list[str]) -> tuple[float, float]:
    """Return the time (s) and the peak of memory (MB) of a process that must succeed."""
    starter = [sys.executable, "-I", "-S", "-c", STARTER, *words]
    ended = subprocess.run(starter, capture_output=True, text=True, check=False)
    if ended.returncode != 0:
        sys.exit(f"{words} ended with {ended.returncode}: {ended.stderr}")
    seconds, kilobytes = ended.stdout.split()
    return float(seconds), float(kilobytes) / 1024


def samples() -> Section:
    """Measure a simulation by the number of its samples."""
    curves: dict[str, Curve] = {"exact": [], "exact at given times": [], "with sensitivities": []}
    for count in (100, 1_000, 10_000, 100_000, 1_000_000):
        given_s = np.sort(np.random.default_rng(1).uniform(0, 10, count))
        calls = (
            lambda n=count: PUMP.simulate(speed_rpm=RPM, duration_s=10, dt_s=10 / n),
            lambda at=given_s: PUMP.simulate(speed_rpm=RPM, time_s=at),
            lambda n=count: PUMP.simulate(speed_rpm=RPM, duration_s=10, dt_s=10 / n, sensitivity=True),
        )
        for curve, call in zip(curves.values(), calls, strict=True):
            curve.append((count, 1e3 * shortest(call)))
    words = (
        "Ten seconds at 100 r/min from rest, with pressures, flows, speed, angle and volume at each instant. "
        "Few samples cost what the motion costs: its edges and stretches. Beyond some 100,000 the memory of "
        "the columns costs more than the numbers."
    )
    return Section("Samples of a simulation", words, "samples", "ms", curves)


def rollers() -> Section:
    """Measure steady states and plans by the number of rollers."""
    curves: dict[str, Curve] = {"steady state": [], "plan of 25 mL": [], "smooth plan of 25 mL": []}
    limits = pm.Limits(max_outlet_kpa=120)
    for count in (2, 3, 4, 6, 8, 12, 16, 20, 24):
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", "[0-9]+ rollers are more than heads have")
            pump = pm.Pump.from_ml_per_rev(
                "head", ml_per_rev=20, rollers=count, inlet=PUMP.inlet, outlet=PUMP.outlet
            )
        doser = pm.Doser(pump, limits)
        calls = (
            lambda pump=pump: pump.steady_state(speed_rpm=RPM),
            lambda doser=doser: doser.plan("25mL", rate="5mL/s", start_angle_rad=0.3),
            lambda doser=doser: doser.plan("25mL", rate="5mL/s", start_angle_rad=0.3, smooth=True),
        )
        for curve, call in zip(curves.values(), calls, strict=True):
            curve.append((count, 1e3 * shortest(call)))
    words = (
        "Heads of 20 mL a revolution, known by that volume alone. More rollers make more and shorter "
        "pulses of a dose. A plan has its pressures, within a limit of the outlet."
    )
    return Section("Rollers", words, "rollers", "ms", curves)


def volumes() -> Section:
    """Measure plans by their volume."""
    curves: dict[str, Curve] = {"known angle": [], "unknown angle": [], "smooth": []}
    doser = pm.Doser(PUMP, pm.Limits(max_outlet_kpa=120))
    for volume_ml in (1, 10, 100, 1_000, 10_000, 100_000):
        volume = f"{volume_ml}mL"
        calls = (
            lambda volume=volume: doser.plan(volume, rate="5mL/s", start_angle_rad=0.3),
            lambda volume=volume: doser.plan(volume, rate="5mL/s", start_half_width_rad=math.pi),
            lambda volume=volume: doser.plan(volume, rate="5mL/s", start_angle_rad=0.3, smooth=True),
        )
        for curve, call in zip(curves.values(), calls, strict=True):
            curve.append((volume_ml, 1e3 * shortest(call)))
    words = (
        "These plans include pressures and a limit at the outlet, up to 100 L, which is 60 million steps. A "
        "plan keeps no list of its steps, and the pressures of whole pitches repeat. So beyond a few "
        "pitches, a plan costs the same for any volume."
    )
    return Section("Volume of a dose", words, "mL", "ms", curves)


def records(dose: str) -> Section:
    """Measure commands by the number of doses on record: the first thousand were made, the others written."""
    commands = {"dose status": ["status"], "dose 0.1mL": ["0.1mL"], "dose log --totals": ["log", "--totals"]}
    curves: dict[str, Curve] = {name: [] for name in commands}
    memory: Curve = []
    with tempfile.TemporaryDirectory() as state:
        place = ["--state-dir", state]
        measured([dose, "0.1mL", "--repeat", "1000", *place])
        for count in (1_000, 10_000, 100_000, 1_000_000):
            lengthen(Path(state) / "three-roller/sim", count)
            peak = 0.0
            for name, typed in commands.items():
                runs = [measured([dose, *typed, *place]) for _ in range(5 if count < 1_000_000 else 3)]
                curves[name].append((count, 1e3 * min(seconds for seconds, _ in runs)))
                peak = max(peak, *(megabytes for _, megabytes in runs))
            memory.append((count, peak))
    words = (
        "The command, with its start, beside more and more doses on record. The first thousand were made. "
        "The lines of the others in the log are copies with numbers and checksums of their own, and so are "
        "older parts of the journal, of which a command needs none. The peak of memory is the largest of "
        "the three commands."
    )
    return Section("Doses on record", words, "doses", "ms", curves, memory)


def lengthen(folder: Path, count: int) -> None:
    """Write lines of the log up to `count` doses, and parts of the journal as many as so many doses make."""
    log, journal = folder / "log.jsonl", folder / "journal.jsonl"
    lines = log.read_text().splitlines()
    numbered = re.search(r'"entry":(\{"number":)\d+(,.*)\}$', lines[-1])
    assert numbered is not None
    with log.open("a") as file:
        for number in range(len(lines) + 1, count + 1):
            entry = f"{numbered[1]}{number}{numbered[2]}"
            file.write(f'{{"crc32":"{zlib.crc32(entry.encode()):08x}","entry":{entry}}}\n')
    # A part is 8 MB, and a dose some 2.5 kB.
    part = folder / "journal-1.jsonl"
    if not part.exists():
        part.write_bytes(journal.read_bytes())
    for number in range(2, count * 2500 // (8 << 20)):
        copy = folder / f"journal-{number}.jsonl"
        if not copy.exists():
            os.link(part, copy)


def heads(count: int) -> Iterator[pm.Pump]:
    """Make pumps on outlet lines from a third of the paper's compliance to three times it."""
    for factor in np.geomspace(1 / 3, 3, count):
        yield PUMP.replace(
            outlet=PUMP.outlet.replace(compliance_ml_kpa=PUMP.outlet.compliance_ml_kpa * factor)
        )


def sweep(points: int, by: str) -> None:
    """Sweep in parts, and keep the largest pressure alone."""
    speeds = np.linspace(10, 170, SPEEDS)

    def highest(executor: Executor | None) -> float:
        parts = pm.sweep_in_parts(heads(points // SPEEDS), speed_rpm=speeds, points=PART, executor=executor)
        return max(float(part.outlet_max_kpa.max()) for part in parts)

    if by == "dask":
        with Client(n_workers=2, threads_per_worker=1, host="127.0.0.1", dashboard_address=None) as client:
            highest(client.get_executor())
    else:
        highest(None)


def sweeps() -> Section:
    """Measure sweeps by their points, on threads and on two processes of Dask."""
    curves: dict[str, Curve] = {"threads": [], "two workers of Dask": []}
    memory: Curve = []
    for points in (1_000, 10_000, 100_000, 1_000_000, 10_000_000):
        for (name, curve), by in zip(curves.items(), ("threads", "dask"), strict=True):
            seconds, megabytes = measured([sys.executable, __file__, "sweep", str(points), by])
            curve.append((points, seconds))
            if name == "threads":
                memory.append((points, megabytes))
    words = (
        f"`pm.sweep_in_parts` over pumps that a generator makes, {SPEEDS:,} speeds of each, {PART:,} points "
        "at a time: steady states with their extremes. Each time includes starting Python, and the "
        "cluster where there is one. The peak of memory is the peak of the process with the threads."
    )
    return Section("Sweeps", words, "points", "s", curves, memory)


def page(sections: list[Section]) -> str:
    """Return the page."""
    cores = os.cpu_count()
    return "\n".join(
        [
            "# How cost grows",
            "",
            "`make bench` measures and draws these curves, and writes this page. The numbers come from "
            f"one machine with {cores} cores, in one run. The trends matter more than the values. "
            "Each time is the shortest of several.",
            "",
            *(section.markdown() for section in sections),
        ]
    )


def main(words: list[str]) -> None:
    """Measure everything and write the page, or make one sweep."""
    if words[:1] == ["sweep"]:
        sweep(int(words[1]), words[2])
        return
    if len(words) != 1:
        sys.exit(__doc__)
    (DOCS / "growth").mkdir(exist_ok=True)
    sections = [samples(), rollers(), volumes(), records(words[0]), sweeps()]
    for section in sections:
        section.draw()
    (DOCS / "growth.md").write_text(wrapped(page(sections)))


def wrapped(text: str) -> str:
    """Return a page whose paragraphs have at most 120 columns."""

    def lines(line: str) -> str:
        return (
            line
            if line.startswith(("|", "<", "#", " "))
            else textwrap.fill(line, 120, break_on_hyphens=False)
        )

    return "\n".join(lines(line) for line in text.split("\n"))


if __name__ == "__main__":
    main(sys.argv[1:])
