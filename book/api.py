"""A preprocessor of mdBook: the reference of the Python module, from its sources and stubs.

The pages come below docs/api.md. Nothing is imported: signatures and docstrings are read from the sources, and those of
the compiled classes from their stubs, whose docstrings the tests hold to the compiled module's.
"""

from collections.abc import Iterator
from pathlib import Path

from api_sources import Definition, Sources
from chapters import add_below, answered
from docstrings import markdown

PACKAGE = Path(__file__).parent.parent / "crates/pump-py/python/pumpmodel"
PARENT = "api.md"

# Pages and the names on them. A public name that no page has is on the last one.
PAGES: dict[str, tuple[str, ...]] = {
    "Pumps and lines": (
        "Pump",
        "Line",
        "LineStates",
        "Hose",
        "Fluid",
        "heads",
        "Head",
        "HeadSource",
        "VolumeFit",
        "SpeedLaw",
    ),
    "Simulation": ("Run", "SteadyState", "sweep", "Sweep", "Harmonics", "rmse", "nrmse", "pearson"),
    "Plans and calibrations": (
        "Doser",
        "Limits",
        "Plan",
        "monte_carlo",
        "VolumeTrials",
        "Calibration",
        "WeighedRun",
        "ShortDose",
        "PhaseFit",
    ),
    "Benches": ("Bench", "AsyncBench", "Balance", "Dose", "LoggedDose", "Status", "Verification"),
    "Racks": ("Rack", "RackReport", "RackPump", "RackDose", "RackTotal"),
    "Identification": (
        *("identify_line", "identify_line_jointly", "identify_resistance", "identify_compliance"),
        *("Identified", "JointlyIdentified", "PressureRecord", "RecordingFit", "Estimate", "LineLikelihood"),
    ),
    "Pictures": ("plot", "plot_pump", "plot_map", "plot_budget", "plot_dose_error", "plot_pitch", "animate"),
    "Errors": (
        *("PumpError", "PlanError", "PumpFileError", "DriveError", "BalanceError"),
        *("SafetyError", "StoppedError", "UnfinishedError"),
    ),
}
LAST = "Further names"


def signature(definition: Definition, name: str) -> str:
    """Return the signature of a function as a block of code."""
    return f"```python\n{definition.signature(name)}\n```\n"


def table(rows: list[tuple[str, str, str]]) -> Iterator[str]:
    """Yield a table of attributes: name, type and meaning."""
    if rows:
        yield "| attribute | type | meaning |\n| --- | --- | --- |"
        for name, kind, meaning in rows:
            told = markdown(meaning).replace("\n", " ").replace("|", "\\|").strip()
            typed = f"`{kind}`".replace("|", "\\|") if kind else ""
            yield f"| `{name}` | {typed} | {told} |"
        yield ""


def section(definition: Definition, name: str, package: str) -> Iterator[str]:
    """Yield the section of a class or a function."""
    yield f"## {name}\n"
    if not definition.is_class:
        yield signature(definition, f"{package}.{name}")
        yield markdown(definition.docstring)
        return
    constructor = definition.constructor().replace("__new__", f"{package}.{name}")
    yield f"```python\nclass {constructor or f'{package}.{name}'}\n```\n"
    yield markdown(definition.docstring)
    yield from table(list(definition.attributes()))
    for method in definition.methods():
        yield f"### {name}.{method.name}\n"
        yield signature(method, method.name)
        yield markdown(method.docstring)


def pages_of(sources: Sources) -> dict[str, str]:
    """Return the text of each page by its title."""
    public = sources.public("pumpmodel")
    listed = {name for names in PAGES.values() for name in names}
    further = tuple(name for name in public if name not in listed and name not in ("choices", "__version__"))
    pages = {}
    for title, names in {**PAGES, LAST: further}.items():
        found = [(name, public[name]) for name in names if name in public]
        if found:
            parts = [part for name, definition in found for part in section(definition, name, "pumpmodel")]
            pages[title] = "\n".join([f"# {title}\n", *parts])
    choices = [f"### {name}\n\n{markdown(told)}\n```text\n{words}\n```\n" for name, words, told in sources.choices()]
    pages["Choices"] = "\n".join(["# Choices\n", markdown(sources.docstring("choices")), *choices])
    robot = sources.public("pumpmodel.pylabrobot")
    parts = [part for name, definition in robot.items() for part in section(definition, name, "pumpmodel.pylabrobot")]
    pages["PyLabRobot"] = "\n".join(["# PyLabRobot\n", markdown(sources.docstring("pylabrobot")), *parts])
    return pages


if __name__ == "__main__":
    answered(lambda book: add_below(book["items"], PARENT, "api", pages_of(Sources(PACKAGE))))
