"""Calls that version 0.1.0 did not have, beside the way to the same result without them, in one run.

Each row has the shortest time of several and the largest difference between the two results. The table is
Markdown, and stands in docs/python.md.
"""

import io
import math
import time
from collections.abc import Callable
from typing import Any, NamedTuple

import matplotlib as mpl
import numpy as np
from matplotlib import pyplot as plt
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import pumpmodel as pm

mpl.use("Agg")

PUMP = pm.Pump.three_roller()
RPM = 100.0


class Row(NamedTuple):
    """A row of the table: a task, the two ways, their times (s), and by how much they differ."""

    task: str
    without: str
    by: str
    without_s: float
    by_s: float
    difference: str


def shortest(call: Callable[[], Any], repeats: int = 5) -> tuple[float, Any]:
    """Return the shortest time of several, s, and the result."""
    best, result = math.inf, None
    for _ in range(repeats):
        begun = time.perf_counter()
        result = call()
        best = min(best, time.perf_counter() - begun)
    return best, result


def angles() -> Row:
    """Find the angle at which a dose ends, for 1,000 doses."""
    volumes = np.linspace(0.1, 100, 1000)

    def by_root(volume_ml: float) -> float:
        most = 2 * math.tau * (1 + volume_ml / PUMP.volume_per_revolution_ml)
        found: float = brentq(lambda angle: PUMP.outlet_volume_ml(angle) - volume_ml, 0, most, xtol=1e-12)
        return found

    before, roots = shortest(lambda: np.array([by_root(volume) for volume in volumes]), 2)
    after, found = shortest(lambda: PUMP.angle_for_volume(volumes, 0.0))
    off = np.abs(roots - found).max()
    return Row(
        "angle at which a dose ends",
        "`brentq` of SciPy",
        "`angle_for_volume`",
        before / 1e3,
        after / 1e3,
        f"{off:.0e} rad",
    )


def likelihood() -> Row:
    """Evaluate the log-likelihood of R, C and L for 1,000 samples."""
    run = PUMP.simulate(speed_rpm=RPM, duration_s=0.999)
    measured = run.outlet_kpa + np.random.default_rng(1).normal(0, 0.3, len(run))
    record = pm.LineLikelihood(
        PUMP,
        time_s=run.time_s,
        pressure_kpa=measured,
        standard_kpa=0.3,
        speed_rpm=RPM,
        begin="step",
        start_angle_rad=0.0,
    )

    def by_hand() -> float:
        line = PUMP.outlet.replace(compliance_ml_kpa=0.036)
        model = PUMP.replace(outlet=line).simulate(speed_rpm=RPM, duration_s=0.999).outlet_kpa
        squares = float(np.sum((measured - model) ** 2))
        return -squares / (2 * 0.3**2) - len(measured) / 2 * math.log(math.tau * 0.3**2)

    before, theirs = shortest(by_hand, 50)
    after, ours = shortest(lambda: record.log_likelihood(compliance_ml_kpa=0.036), 50)
    return Row(
        "likelihood of a line, 1,000 samples",
        "`simulate` and NumPy",
        "`LineLikelihood`",
        before,
        after,
        f"{abs(ours - theirs):.0e}",
    )


def motion() -> Row:
    """Run up, hold, and brake: 2,001 samples of the outlet's pressure."""
    times, rpm = np.array([0, 0.3, 1.5, 1.7, 2]), np.array([0, 120, 120, 0, 0])
    output = np.linspace(0, 2, 2001)
    speeds = rpm * math.tau / 60
    turned = np.concatenate(([0], np.cumsum(np.diff(times) * (speeds[1:] + speeds[:-1]) / 2)))
    line = PUMP.outlet

    def change(time_s: float, state: NDArray[np.float64]) -> list[float]:
        speed = np.interp(time_s, times, speeds)
        piece = max(0, int(np.searchsorted(times, time_s)) - 1)
        angle = turned[piece] + (time_s - times[piece]) * (speeds[piece] + speed) / 2
        kpa, flow = state
        return [
            (PUMP.outlet_flow_ml_rad(angle) * speed - flow) / line.compliance_ml_kpa,
            (kpa - line.reservoir_kpa - line.resistance_kpa_s_ml * flow) / line.inertance_kpa_s2_ml,
        ]

    def by_scipy() -> NDArray[np.float64]:
        start = [line.reservoir_kpa, 0.0]
        solved = solve_ivp(change, (0, 2), start, "LSODA", output, rtol=1e-7, atol=1e-7, max_step=0.01)
        kpa: NDArray[np.float64] = solved.y[0]
        return kpa

    before, theirs = shortest(by_scipy, 2)
    after, ours = shortest(lambda: PUMP.simulate(time_s=times, speed_rpm=rpm, output_time_s=output))
    off = np.abs(ours.outlet_kpa - theirs).max()
    return Row(
        "speeds at times, 2 s",
        "`solve_ivp` of SciPy",
        "`simulate(time_s=...)`",
        before,
        after,
        f"{off:.0e} kPa",
    )


def steady() -> Row:
    """Find one second of the steady state."""
    before, theirs = shortest(lambda: PUMP.simulate(speed_rpm=RPM, duration_s=6))
    after, ours = shortest(lambda: PUMP.simulate(speed_rpm=RPM, duration_s=0.999, initial="steady"))
    # 5 s are 25 pitches.
    off = np.abs(ours.outlet_kpa - theirs.outlet_kpa[5000:-1]).max()
    return Row(
        "a second of the steady state", "6 s from rest", '`initial="steady"`', before, after, f"{off:.0e} kPa"
    )


def harmonics() -> Row:
    """Find five harmonics of the outlet's pressure."""

    def by_fft() -> NDArray[np.float64]:
        run = PUMP.simulate(speed_rpm=RPM, duration_s=6, dt_s=1e-3)
        spectrum = np.fft.rfft(run.outlet_kpa[5000:6000]) * 2 / 1000
        found: NDArray[np.float64] = np.abs(spectrum[5:30:5])
        return found

    before, theirs = shortest(by_fft)
    after, found = shortest(lambda: PUMP.harmonics(5, speed_rpm=RPM))
    off = np.abs(np.abs(found.pressure_kpa) - theirs).max()
    return Row(
        "five harmonics of a pressure", "FFT of 6 s from rest", "`harmonics`", before, after, f"{off:.0e} kPa"
    )


def picture() -> Row:
    """Draw the pressures of an hour at a millisecond as a PNG."""
    run = PUMP.simulate(speed_rpm=RPM, duration_s=3600)

    def every_sample() -> int:
        figure, axis = plt.subplots(figsize=(7, 4))
        for kpa in (run.inlet_kpa, run.outlet_kpa):
            axis.plot(run.time_s, kpa, linewidth=1.2)
        return saved(figure)

    def saved(figure: Any) -> int:
        file = io.BytesIO()
        figure.savefig(file)
        plt.close(figure)
        return len(file.getvalue())

    before, _ = shortest(every_sample, 2)
    after, axis = shortest(lambda: run.plot(panels="pressure"), 1)
    drawn = [float(np.max(line.get_ydata())) for line in axis.lines]
    lost = max(abs(drawn[0] - run.inlet_kpa.max()), abs(drawn[1] - run.outlet_kpa.max()))
    after, _ = shortest(lambda: saved(run.plot(panels="pressure").figure), 2)
    return Row(
        "picture of an hour, 3.6 million samples",
        "every sample",
        "`run.plot()`",
        before,
        after,
        f"{lost:g} kPa of the extremes",
    )


def told(number: float) -> str:
    """Return a number with two digits."""
    return f"{number:.0f}" if number >= 10 else f"{number:.2g}"


def duration(seconds: float) -> str:
    """Return a time with two digits and its unit."""
    for factor, unit in ((1, "s"), (1e3, "ms")):
        if factor * seconds >= 1:
            return f"{told(factor * seconds)} {unit}"
    return f"{told(1e6 * seconds)} µs"


if __name__ == "__main__":
    print("| task | without | by | without | by | times faster | difference |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    for make in (angles, likelihood, motion, steady, harmonics, picture):
        row = make()
        cells = (
            *(row.task, row.without, row.by, duration(row.without_s), duration(row.by_s)),
            *(told(row.without_s / row.by_s), row.difference),
        )
        print(f"| {' | '.join(cells)} |")
