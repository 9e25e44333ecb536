"""Arguments of wrong types and sizes: the message names them, and stays short."""

from collections.abc import Callable
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pumpmodel as pm

THREE = pm.Pump.three_roller()
DOSER = pm.Doser(THREE)
RUN = THREE.simulate(speed_rpm=60, duration_s=0.1)
SWEEP = pm.sweep(THREE, speed_rpm=[50, 100])
LONG: Any = "9" * 500
FIVE: Any = 5
NONE: Any = None
REVOLUTION_ML = THREE.volume_per_revolution_ml
CALIBRATION = pm.Calibration.from_runs(
    THREE,
    [
        pm.WeighedRun(speed_rpm=speed, turned_deg=720, volume_ml=2 * REVOLUTION_ML * factor)
        for speed, factor in ((20, 0.99), (60, 1.0), (100, 1.01))
    ],
)


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (
            lambda: THREE.harmonics(10**400, speed_rpm=60),
            ValueError,
            "count is a whole number beyond 64 bits",
        ),
        (lambda: THREE.harmonics(NONE, speed_rpm=60), TypeError, "count must be a whole number, not None"),
        (
            lambda: pm.WeighedRun(speed_rpm=NONE, turned_deg=1),
            TypeError,
            "speed_rpm must be a number in r/min, not NoneType",
        ),
        (
            lambda: pm.Experiment(speed_rpm=NONE, duration_s=1),
            TypeError,
            "speed_rpm must be a number in r/min, not NoneType",
        ),
        (
            lambda: pm.Hose(bore_radius_mm=NONE, outer_radius_mm=6, length_mm=5, modulus_mpa=3),
            TypeError,
            "bore_radius_mm must be a number in mm, not NoneType",
        ),
        (lambda: pm.sweep(FIVE, speed_rpm=1), TypeError, "pumps must be a sequence of Pumps, not int"),
        (
            lambda: pm.sweep(THREE, speed_rpm=1, progress=FIVE),
            TypeError,
            "progress must be a function of the points done and their total, True or False, not int",
        ),
        (
            lambda: pm.sweep(THREE, speed_rpm=1, executor=FIVE),
            TypeError,
            "executor must be an Executor, as a ProcessPoolExecutor, not int",
        ),
        (
            lambda: pm.sweep_in_parts(THREE, speed_rpm=1, points=-(10**400)),
            ValueError,
            "points is a whole number below -1e18; allowed: 1 or more",
        ),
        (
            lambda: pm.sweep_in_parts(FIVE, speed_rpm=1),
            TypeError,
            "pumps must be a Pump or an iterable of Pumps, not int",
        ),
        (
            lambda: pm.identify_line_jointly(THREE, FIVE),
            TypeError,
            "recordings must be a sequence of PressureRecords, not int",
        ),
        (
            lambda: pm.Calibration.from_runs(THREE, FIVE),
            TypeError,
            "runs must be a sequence of WeighedRuns, not int",
        ),
        (lambda: pm.Bench.open(FIVE), TypeError, "pump must be a Pump, a name or a path, not int"),
        (
            lambda: pm.Bench.open(THREE, state_dir=FIVE),
            TypeError,
            "state_dir must be a text or a path, not int",
        ),
        (lambda: pm.Bench.open(THREE, driver=FIVE), TypeError, "driver must be a text, not int"),
        (
            lambda: pm.Pump.from_ml_per_rev("a", ml_per_rev=1e308, rollers=3),
            ValueError,
            "ml_per_rev is 1e308; allowed: 0.000001 to 100000",
        ),
        (lambda: DOSER.plan("1mL", finish=LONG), ValueError, "finish is '999999"),
        (lambda: DOSER.plan("1mL", finish=FIVE), TypeError, "finish must be a text, not int"),
        (lambda: THREE.replace(id=FIVE), TypeError, "id must be a text, not int"),
        (
            lambda: pm.VolumeFit([0, 1, 2], [0, 1, 2], method=NONE),
            TypeError,
            "method must be a text, not NoneType; allowed: spline, quintic",
        ),
    ],
)
def test_a_wrong_argument_is_named(call: Callable[[], Any], error: type[Exception], message: str) -> None:
    with pytest.raises(error) as raised:
        call()
    assert str(raised.value).startswith(message)
    assert len(str(raised.value)) < 250


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (lambda: RUN.plot(panels=LONG), ValueError, "panels is '999"),
        (lambda: RUN.plot(panels=[]), ValueError, "panels is empty; allowed: one name at least of flow"),
        (lambda: RUN.plot(panels=FIVE), TypeError, "panels must be a sequence of names, not int"),
        (lambda: SWEEP.plot(LONG), ValueError, "quantity is '999"),
        (lambda: THREE.animate(RUN, slower=1e308), ValueError, "the animation has inf frames; allowed"),
        (lambda: pm.plot_dose_error(THREE, []), ValueError, "volume_ml is empty; allowed: one volume"),
    ],
)
def test_a_wrong_argument_of_a_picture_is_named(
    call: Callable[[], Any], error: type[Exception], message: str
) -> None:
    pytest.importorskip("matplotlib")
    with pytest.raises(error) as raised:
        call()
    assert str(raised.value).startswith(message)
    assert len(str(raised.value)) < 250


@pytest.mark.parametrize("number", [Decimal("0.5"), Fraction(1, 2)])
def test_exact_numbers_of_python_are_numbers_alone_and_in_arrays(number: Any) -> None:
    assert THREE.outlet_volume_ml(number) == THREE.outlet_volume_ml(0.5)
    np.testing.assert_array_equal(THREE.outlet_volume_ml([number, 1]), THREE.outlet_volume_ml([0.5, 1]))
    assert THREE.simulate(speed_rpm=60, duration_s=number) == THREE.simulate(speed_rpm=60, duration_s=0.5)


def changed(*keys: Any, to: Any) -> dict[str, Any]:
    data = CALIBRATION.to_dict()
    place: Any = data
    for key in keys[:-1]:
        place = place[key]
    place[keys[-1]] = to
    return data


def test_numbers_of_numpy_are_plain_data() -> None:
    data = changed("version", to=np.int64(3))
    data["displacement"]["speeds_rpm"] = np.asarray(data["displacement"]["speeds_rpm"])
    data["temperature_degc"] = np.float32(20)
    found = pm.Calibration.from_dict(data)
    assert found.version == 3
    assert found.speeds_rpm == pytest.approx([20, 60, 100])
    assert pm.Calibration.from_dict(CALIBRATION.to_dict()) == CALIBRATION


@pytest.mark.parametrize(
    ("data", "error", "message"),
    [
        (
            changed("displacement", "factor", to=float("nan")),
            ValueError,
            "displacement.factor is nan; allowed",
        ),
        (changed("displacement", "factor", to=0), ValueError, "displacement.factor is 0; allowed: 0.5 to 2"),
        (
            changed("displacement", "factor", to=-5),
            ValueError,
            "displacement.factor is -5; allowed: 0.5 to 2",
        ),
        (changed("displacement", "factor", to=1e300), ValueError, "displacement.factor is 1e300; allowed"),
        (
            changed("displacement", "factor", to="1"),
            ValueError,
            'displacement.factor: invalid type: the text "1"',
        ),
        (
            changed("displacement", "factor", to=Decimal(1)),
            TypeError,
            "hold a Decimal at displacement.factor",
        ),
        (
            changed("runs", 0, "reading", to={"mass_g": -5}),
            ValueError,
            "runs[0].reading.mass_g is -5; allowed",
        ),
        (changed("runs", 1, "speed_rpm", to=-5), ValueError, "runs[1].speed_rpm is -5; allowed: more than 0"),
        (changed("runs", 2, "turned_deg", to=0), ValueError, "runs[2].turned_deg is 0; allowed"),
        (changed("steps_per_rev", to=-1e300), ValueError, "steps_per_rev is -1e300; allowed"),
        (changed("version", to=-1), ValueError, "version is -1; allowed: 0 to"),
        ({}, ValueError, "version is missing"),
        (FIVE, TypeError, "data must be a dict, not int"),
    ],
)
def test_data_that_no_calibration_has_are_refused_by_their_key(
    data: Any, error: type[Exception], message: str
) -> None:
    with pytest.raises(error) as raised:
        pm.Calibration.from_dict(data)
    assert message in str(raised.value)
    assert " line " not in str(raised.value)
    assert len(str(raised.value)) < 250


def test_data_that_hold_themselves_are_refused() -> None:
    data = CALIBRATION.to_dict()
    data["displacement"]["speeds_rpm"] = data["runs"]
    data["runs"].append(data["runs"])
    with pytest.raises(ValueError, match="holds itself"):
        pm.Calibration.from_dict(data)


def test_derivatives_are_columns_of_tables_and_count_for_equality() -> None:
    pytest.importorskip("pandas")
    pytest.importorskip("xarray")
    run = THREE.simulate(speed_rpm=60, duration_s=0.1, sensitivity=True)
    table = run.to_dataframe()
    name = "outlet_kpa_by_compliance_ml_kpa"
    assert table.attrs["units"][name] == "kPa/(mL/kPa)"
    assert run.to_xarray()[name].attrs["units"] == "kPa/(mL/kPa)"
    assert pm.Run.from_dict(table) == run
    assert pm.Run.from_dict(table[list(RUN.to_dict())]) != run
    assert run != THREE.simulate(speed_rpm=60, duration_s=0.1)


def test_a_bench_has_its_last_dose(tmp_path: Path) -> None:
    def interrupted(made: int, planned: int) -> None:
        raise KeyboardInterrupt

    with pm.Bench.open(THREE, state_dir=tmp_path, pace="real") as bench:
        assert bench.last_dose is None
        dose = bench.dose("0.5mL")
        assert bench.last_dose == dose
        with pytest.raises(ValueError, match="volume"):
            bench.dose("x")
        with pytest.raises(KeyboardInterrupt):
            bench.dose("5mL", progress=interrupted)
        last = bench.last_dose
        assert last is not None
        assert last.requested_ml == 5
        assert not last.completed
