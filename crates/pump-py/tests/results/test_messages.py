"""Messages of refusals: they name the argument, and stay short."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import pumpmodel as pm

THREE = pm.Pump.three_roller()
DOSER = pm.Doser(THREE)


def changed(table: str, key: str, value: Any) -> dict[str, Any]:
    data = THREE.to_dict()
    data[table][key] = value
    return data


@pytest.mark.parametrize(
    ("call", "error", "begin"),
    [
        (lambda: DOSER.plan("9" * 300 + "mL"), ValueError, "volume in mL is 1e300; allowed"),
        (lambda: DOSER.plan("x" * 5000), ValueError, "volume: `xxx"),
        (lambda: DOSER.plan("5 bananas"), ValueError, "volume: `5 bananas`"),
        (lambda: DOSER.plan("5mL", rate="7"), ValueError, "rate: `7` has no unit"),
        (lambda: DOSER.plan("5mL", within="7"), ValueError, "within: `7` has no unit"),
        (lambda: DOSER.plan("5mL", retract="7"), ValueError, "retract: `7` has no unit"),
        (lambda: THREE.replace(rollers=10**300), ValueError, "rollers is a whole number beyond 64 bits"),
        (lambda: THREE.replace(rollers=2.5), TypeError, "rollers must be a whole number"),  # type: ignore[arg-type]
        (lambda: THREE.replace(id="x" * 500), ValueError, "pump file xxx"),
        (lambda: pm.Pump.three_roller("x" * 3000), ValueError, "variant is 'xxx"),  # type: ignore[arg-type]
        (
            lambda: pm.Pump.from_dict(changed("rollers", "count", "three")),
            ValueError,
            "these are not the",
        ),
        (
            lambda: pm.Pump.from_dict(changed("rollers", "x" * 3000, 1)),
            ValueError,
            "these are not the",
        ),
        (lambda: pm.WeighedRun(speed_rpm=60, turned_deg=720).weighed("5"), ValueError, "reading: `5`"),
    ],
)
def test_a_refusal_names_the_argument_and_is_short(
    call: Callable[[], Any], error: type[Exception], begin: str
) -> None:
    with pytest.raises(error) as raised:
        call()
    assert str(raised.value).startswith(begin)
    assert len(str(raised.value)) < 500


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (
            changed("rollers", "count", "three"),
            'rollers.count: invalid type: the text "three", expected',
        ),
        (
            changed("rollers", "count", 1e300),
            "rollers.count: invalid type: the number `1e+300`, expected",
        ),
        (changed("rollers", "radius_mm", float("nan")), "one of its numbers is not finite"),
        (3, "invalid type: the number `3`, expected a dict"),
    ],
)
def test_wrong_data_of_a_pump_are_told_by_their_keys_and_not_by_json(data: Any, message: str) -> None:
    with pytest.raises(pm.PumpFileError) as raised:
        pm.Pump.from_dict(data)
    assert message in str(raised.value)
    assert " line " not in str(raised.value)


@pytest.mark.parametrize(
    ("keywords", "message"),
    [
        ({"limits": 3}, "limits must be a Limits, not int"),
        ({"smooth": "yes"}, "smooth must be True or False, not str"),
        ({"start_angle_rad": "1"}, "start_angle_rad must be a number, not str"),
        ({"finish": 1}, "finish must be a word, not int"),
        ({"rate": 3}, "rate must be text with its unit"),
    ],
)
def test_a_keyword_of_the_wrong_type_is_named(tmp_path: Path, keywords: dict[str, Any], message: str) -> None:
    with pm.Bench.open(THREE, state_dir=tmp_path) as bench, pytest.raises(TypeError, match=message):
        bench.dose("5mL", **keywords)


def test_whole_numbers_and_runs_of_a_bench_are_checked_by_name(tmp_path: Path) -> None:
    wrong: Any = [3]
    with pm.Bench.open(THREE, state_dir=tmp_path) as bench:
        for count in (-3, 0, 10**30):
            with pytest.raises(ValueError, match=r"pitches is .*; allowed: 1 to 100000"):
                bench.calibration_run(speed_rpm=60, pitches=count)
            with pytest.raises(ValueError, match=r"count is .*; allowed: 1 to 1000000"):
                list(bench.batch("1mL", count))
        with pytest.raises(ValueError, match="version is -1"):
            bench.use_calibration(-1)
        with pytest.raises(TypeError, match="runs must be WeighedRuns, not int"):
            bench.calibrate(wrong)
        with pytest.raises(ValueError, match=r"readings\[1\]: `x`"):
            bench.verify("10mL", ["9.9g", "x"])
