"""Python, the command and Rust: one machine, the same bits."""

import csv
import json
import os
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pumpmodel as pm
from pumpmodel._results.renamed import COLUMNS

ROOT = Path(__file__).parents[4]
PUMPS = ["three-roller", "two-roller"]
# The traces of the command, and the crates, keep the former names.
IN_TRACE = {name: former for former, name in COLUMNS.items()}


def output(*command: str) -> str:
    ended = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stderr
    return ended.stdout


@pytest.fixture(scope="module")
def made() -> dict[str, str]:
    """The command and the example in Rust, as `cargo test` builds them."""
    words = ("build", "--locked", "--quiet", "--bin", "dose", "--example", "numbers")
    messages = map(json.loads, output("cargo", *words, "--message-format", "json").splitlines())
    return {
        message["target"]["name"]: message["executable"]
        for message in messages
        if message.get("executable") is not None
    }


@pytest.fixture(scope="module")
def dose(made: dict[str, str]) -> Callable[..., Any]:
    return lambda *words: json.loads(output(made["dose"], *words, "--format", "json"))


@pytest.fixture(scope="module")
def rust(made: dict[str, str]) -> dict[str, Any]:
    """Numbers from the crates, each as its shortest text that reads back as the same bits."""
    numbers: dict[str, Any] = json.loads(output(made["numbers"]))
    return numbers


def without_words(report: dict[str, Any]) -> dict[str, Any]:
    """Return a report without its time, what was typed, and the remedies: the command names its options."""
    budget = [{**share, "remedy": None} for share in report["uncertainty_budget"]]
    return {**report, "uncertainty_budget": budget, "time": None, "asked": None}


@pytest.mark.parametrize("name", PUMPS)
def test_a_dose_and_its_waveform_are_the_same_to_the_last_bit(
    name: str, tmp_path: Path, dose: Callable[..., Any], rust: dict[str, Any]
) -> None:
    steps, trace = tmp_path / "steps.csv", tmp_path / "trace.csv"
    command = dose(
        *("25mL", "--rate", "10mL/s", "--pump", name, "--dry-run", "--state-dir", os.fspath(tmp_path)),
        *("--steps", os.fspath(steps), "--trace", os.fspath(trace)),
    )
    plan = pm.Doser(pm.Pump.named(name)).plan("25mL", rate="10 mL/s")
    python = plan.to_dict()
    assert command.pop("phase") == {**python.pop("phase"), "source": "home"}
    assert without_words(python) == without_words(command)
    assert {key: python[key] for key in rust[name]["dose"]} == rust[name]["dose"]
    with steps.open() as lines:
        rows = list(csv.DictReader(lines))
    np.testing.assert_array_equal(plan.step_times_s, [float(row["time_s"]) for row in rows])
    np.testing.assert_array_equal(plan.step_angles_rad, [float(row["angle_rad"]) for row in rows])
    with trace.open() as lines:
        samples = list(csv.DictReader(lines))
    for column, numbers in plan.trace().to_dict().items():
        traced = [float(sample[IN_TRACE.get(column, column)]) for sample in samples]
        np.testing.assert_array_equal(numbers, traced, err_msg=column)


@pytest.mark.parametrize("name", PUMPS)
def test_a_simulation_is_the_same_to_the_last_bit(
    name: str, tmp_path: Path, dose: Callable[..., Any], rust: dict[str, Any]
) -> None:
    trace = tmp_path / "trace.csv"
    command = dose(
        *("simulate", "--speed", "100rpm", "--duration", "2s", "--pump", name, "--trace", os.fspath(trace))
    )
    pump = pm.Pump.named(name)
    steady = pump.steady_state(speed_rpm=100).to_dict()
    assert steady.pop("speed_rpm") == command["speed_rpm"]
    assert steady == command["steady"] == rust[name]["steady"]
    run = pump.simulate(speed_rpm=100, duration_s=2)
    with trace.open() as lines:
        samples = list(csv.DictReader(lines))
    for column, numbers in run.to_dict().items():
        traced = [float(sample[IN_TRACE.get(column, column)]) for sample in samples]
        np.testing.assert_array_equal(numbers, traced, err_msg=column)
    for column, last in rust[name]["last"].items():
        assert float(run.to_dict()[COLUMNS.get(column, column)][-1]) == last, column


@pytest.mark.parametrize("name", PUMPS)
def test_a_simulated_dose_is_the_same_to_the_last_bit(
    name: str, tmp_path: Path, dose: Callable[..., Any], rust: dict[str, Any]
) -> None:
    command = dose("7mL", "--within", "4s", "--pump", name, "--state-dir", os.fspath(tmp_path / "command"))
    with pm.Bench.open(name, state_dir=tmp_path / "python") as bench:
        python = bench.dose("7mL", within="4s").to_dict()
    assert without_words(python) == without_words(command)
    assert python["delivered_ml"] == rust[name]["delivered_ml"]


def test_lines_that_are_identified_are_the_same_to_the_last_bit(dose: Callable[..., Any]) -> None:
    examples = ROOT / "examples" / "identification"

    def command(kind: str, *words: str) -> Any:
        return dose("identify", kind, "--data", os.fspath(examples / words[0]), *words[1:])

    def columns(name: str) -> list[list[float]]:
        lines = (examples / name).read_text().splitlines()
        rows = list(csv.reader(line for line in lines if not line.startswith("#")))[1:]
        return [[float(cell) for cell in column] for column in zip(*rows, strict=True)]

    pump = pm.Pump.three_roller()
    flow_ml_s, drop_kpa = columns("resistance.csv")
    resistance = pm.identify_resistance(flow_ml_s, drop_kpa=drop_kpa)
    assert resistance.to_dict() == command("resistance", "resistance.csv")
    volume_ml, pressure_kpa = columns("compliance.csv")
    compliance = pm.identify_compliance(volume_ml, pressure_kpa, total_ml=26)
    assert compliance.to_dict() == command("compliance", "compliance.csv", "--total-volume", "26mL")
    time_s, waveform_kpa = columns("start.csv")
    for speed in (100, 90):
        line = pm.identify_line(pump, time_s=time_s, pressure_kpa=waveform_kpa, speed_rpm=speed)
        assert line.to_dict() == command("line", "start.csv", "--speed", f"{speed}rpm")
