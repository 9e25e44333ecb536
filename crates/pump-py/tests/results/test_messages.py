"""Messages of refusals: they name the argument, and stay short."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pumpmodel as pm

THREE = pm.Pump.three_roller()
# Classes where objects are needed.
CLASSES: Any = pm
HOSE = pm.Hose(bore_radius_mm=4, outer_radius_mm=6, length_mm=500, modulus_mpa=3.5)
DOSER = pm.Doser(THREE)
TIMES = np.arange(300) * 2e-3


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


def simulated(**keywords: Any) -> pm.Run:
    return THREE.simulate(**{"speed_rpm": 60, "duration_s": 1, **keywords})


def identified(**keywords: Any) -> pm.Identified:
    data: dict[str, Any] = {"time_s": TIMES, "pressure_kpa": 90 + TIMES, "speed_rpm": 60}
    return pm.identify_line(THREE, **{**data, **keywords})


LINE: dict[str, Any] = THREE.outlet.to_dict()
HUGE = 10**400
TEXT: Any = "50"


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (lambda: simulated(duration_s="1s"), TypeError, "duration_s must be a number in s, not str"),
        (
            lambda: simulated(dt_s=HUGE),
            ValueError,
            "dt_s is a whole number beyond 1.8e308",
        ),
        (lambda: simulated(start_angle_rad=HUGE), ValueError, "start_angle_rad is a whole number beyond"),
        (lambda: simulated(speed_rpm=HUGE), ValueError, "speed_rpm is a whole number beyond 1.8e308"),
        (lambda: simulated(speed_rpm=0), ValueError, "speed_rpm is 0; allowed: 9.5e-6 or more either way"),
        (lambda: simulated(duration_s=0), ValueError, "duration_s is 0; allowed: more than 0"),
        (lambda: simulated(dt_s=0), ValueError, "dt_s is 0; allowed: more than 0, duration_s at most"),
        (
            lambda: simulated(speed_rpm=lambda t: "fast"),
            TypeError,
            "speed_rpm at 0.0002113248654051871 s must be a number in r/min, not str",
        ),
        (
            lambda: simulated(speed_rpm=[60, 60], time_s=[[0, 1], [2]], duration_s=None),
            ValueError,
            "time_s is no array of numbers in s: its parts differ in shape",
        ),
        (
            lambda: simulated(speed_rpm="60"),
            TypeError,
            "speed_rpm must be a number or an array of",
        ),
        (
            lambda: THREE.steady_state(speed_rpm=[10, 0]),
            ValueError,
            "speed_rpm is 0; allowed: a finite speed",
        ),
        (lambda: THREE.steady_state(speed_rad_s=0), ValueError, "speed_rad_s is 0; allowed: a finite speed"),
        (lambda: pm.sweep([THREE], speed_rpm=[[1], [1, 2]]), ValueError, "speed_rpm is no array of"),
        (lambda: identified(fit=[]), ValueError, 'fit is empty; allowed: one name at least of "R", "C"'),
        (lambda: identified(speed_rpm=0), ValueError, "speed_rpm is 0; allowed: a finite"),
        (lambda: identified(start_s="0"), TypeError, "start_s must be a number in s, not str"),
        (
            lambda: identified(pressure_kpa=100 * (90 + np.sin(31 * TIMES))),
            ValueError,
            "the fit explains less than 0 % of how",
        ),
        (
            lambda: pm.LineLikelihood(
                THREE,
                time_s=TIMES,
                pressure_kpa=TIMES,
                standard_kpa=TEXT,
                speed_rpm=60,
            ),
            TypeError,
            "standard_kpa must be a number in kPa, not str",
        ),
        (
            lambda: pm.Line(**{**LINE, "resistance_kpa_s_ml": "0.1"}),
            TypeError,
            "resistance_kpa_s_ml must be a number in kPa s/mL, not str",
        ),
        (
            lambda: THREE.outlet.replace(compliance_ml_kpa=HUGE),
            ValueError,
            "compliance_ml_kpa is a whole",
        ),
        (
            lambda: pm.Hose(bore_radius_mm=4, outer_radius_mm=6, length_mm=TEXT, modulus_mpa=3.5),
            TypeError,
            "length_mm must be a number in mm, not str",
        ),
        (
            lambda: pm.WeighedRun(speed_rpm=60, turned_deg=720, mass_g=TEXT),
            TypeError,
            "mass_g must be a number in g, not str",
        ),
        (
            lambda: pm.WeighedRun(speed_rpm=TEXT, turned_deg=720),
            TypeError,
            "speed_rpm must be a number in r/min, not str",
        ),
        (
            lambda: pm.Fluid.water(temperature_degc=TEXT),
            TypeError,
            "temperature_degc must be a number in degC, not str",
        ),
        (lambda: DOSER.plan("5mL", carry_in_ml=HUGE), ValueError, "carry_in_ml is a whole number beyond"),
        (
            lambda: pm.Limits(max_outlet_kpa=TEXT),
            TypeError,
            "max_outlet_kpa must be a number in kPa, not str",
        ),
    ],
)
def test_a_number_is_refused_by_its_name_and_unit(
    call: Callable[[], Any], error: type[Exception], message: str
) -> None:
    with pytest.raises(error) as raised:
        call()
    assert str(raised.value).startswith(message)
    assert "numpy" not in str(raised.value).lower()


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
        (changed("rollers", "radius_mm", float("nan")), "rollers.radius_mm is nan; allowed: a finite number"),
        (3, "invalid type: the number `3`, expected a dict"),
    ],
)
def test_wrong_data_of_a_pump_are_told_by_their_keys_and_not_by_json(data: Any, message: str) -> None:
    with pytest.raises(pm.PumpFileError) as raised:
        pm.Pump.from_dict(data)
    assert message in str(raised.value)
    assert " line " not in str(raised.value)


PLAN = DOSER.plan("1mL", start_angle_rad=0.3)
DOSE = pm.Dose.from_dict(PLAN.to_dict())
TRIALS = pm.monte_carlo(PLAN, trials=10, seed=1)
RUN = THREE.simulate(speed_rpm=60, duration_s=0.1)
ONE = [pm.Experiment(speed_rpm=60, duration_s=1)]


NUMBER: Any = 2
WRONG: Any = DOSE
WRONG_PUMP: Any = THREE


def ranked(**keywords: Any) -> Any:
    return pm.next_experiment(THREE, **{"candidates": ONE, "standard_kpa": 0.3, **keywords})


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (lambda: simulated(sensitivity=1), TypeError, "sensitivity must be True or False, not int"),
        (lambda: DOSER.plan("1mL", smooth=TEXT), TypeError, "smooth must be True or False, not str"),
        (
            lambda: pm.identify_resistance([1, 2], drop_kpa=[1, 2], offset=NUMBER),
            TypeError,
            "offset must be True or False, not int",
        ),
        (lambda: pm.monte_carlo(WRONG), TypeError, "plan must be a Plan, not Dose; pm.Doser(pump).plan("),
        (lambda: pm.monte_carlo(PLAN, seed=-1), ValueError, "seed is -1; allowed: 0 to 18,446,744,"),
        (lambda: pm.monte_carlo(PLAN, seed=TEXT), TypeError, "seed must be a whole number, not str"),
        (
            lambda: pm.monte_carlo(PLAN, trials=HUGE),
            ValueError,
            "trials is a whole number beyond 64 bits; allowed: 2 to 10,000,000",
        ),
        (lambda: TRIALS.interval_ml(TEXT), TypeError, "coverage must be a number in parts of 1, not str"),
        (lambda: TRIALS.interval_ml(95), ValueError, "coverage is 95; allowed: above 0 and below 1"),
        (
            lambda: ranked(unknown="reservoir"),
            TypeError,
            "unknown is a text, 'reservoir'; allowed: a sequence of names, as",
        ),
        (lambda: ranked(candidates=[100]), TypeError, "candidates[0] must be an Experiment, not int"),
        (lambda: ranked(candidates=ONE[0]), TypeError, "candidates must be a sequence of Experiments, not"),
        (lambda: ranked(candidates=[]), ValueError, "candidates is empty; allowed: one Experiment at"),
        (lambda: ranked(known=THREE), TypeError, "known must be what an identification returned, as"),
        (lambda: ranked(standard_kpa="1"), TypeError, "standard_kpa must be a number in kPa, not str"),
        (lambda: pm.VolumePolynomial("abc", 50), TypeError, "coefficients_ml_deg must be a number or an"),
        (
            lambda: pm.VolumeFit(["a"], [1]),
            TypeError,
            "angle_deg must be a number or an array of numbers in deg",
        ),
        (
            lambda: pm.VolumeFit([0, 1], ["a", "b"]),
            TypeError,
            "volume_ml must be a number or an array of numbers in mL, not list with the text 'a' at",
        ),
        (
            lambda: pm.rmse(np.array(["1", "2,5"]), [1, 2]),
            TypeError,
            "model must be a number or an array of numbers, not ndarray with the text '2,5' at place 1,",
        ),
        (
            lambda: THREE.outlet_volume_ml(["1", "2"]),
            TypeError,
            "angle_rad must be a number or an array of numbers in rad, not list of texts; turn them into",
        ),
        (
            lambda: THREE.outlet_volume_ml([1, None]),
            TypeError,
            "angle_rad must be a number or an array of numbers in rad, not list with NoneType at place 1",
        ),
        (
            lambda: THREE.outlet_volume_ml([1j]),
            TypeError,
            "angle_rad must be a number or an array of numbers in rad, not list with complex128 at place 0",
        ),
        (
            lambda: pm.VolumeFit([0, 50], [0, 2]),
            ValueError,
            "angle_deg has 2 different angles; allowed: 3 or more for the method 'spline'; measure at more",
        ),
        (
            lambda: THREE.replace(inlet=CLASSES.Hose),
            TypeError,
            "inlet must be a Line, not the class Hose itself; hose",
        ),
        (
            lambda: THREE.replace(outlet=TEXT),
            TypeError,
            "outlet must be a Line, not the text '50'; hose.line(fluid",
        ),
        (
            lambda: THREE.replace(roller_volume=CLASSES.VolumeFit),
            TypeError,
            'roller_volume must be a VolumeFit, a VolumePolynomial or "drawing", not the class VolumeFit',
        ),
        (
            lambda: pm.Doser(CLASSES.Pump),
            TypeError,
            "pump must be a Pump, not the class Pump itself; pm.Pump.three_r",
        ),
        (
            lambda: pm.identify_line(TEXT, time_s=[0], pressure_kpa=[1], speed_rpm=1),
            TypeError,
            "pump must be a Pump, not the text '50'; pm.Pump.three_roller() makes one",
        ),
        (
            lambda: HOSE.line(CLASSES.Fluid, reservoir_kpa=100, flow_ml_s=1),
            TypeError,
            "fluid must be a Fluid, not the class Fluid itself; pm.Fluid.water(temperature_degc=20) makes",
        ),
    ],
)
def test_an_argument_of_an_analysis_is_refused_by_its_name(
    call: Callable[[], Any], error: type[Exception], message: str
) -> None:
    with pytest.raises(error) as raised:
        call()
    assert str(raised.value).startswith(message)
    assert len(str(raised.value)) < 300


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: pm.plot_dose_error(THREE, TEXT), "volume_ml must be a number or an array of numbers in mL"),
        (lambda: THREE.plot(angle_rad=TEXT), "angle_rad must be a number in rad, not str"),
        (lambda: pm.plot_budget(WRONG_PUMP), "dose must be a Dose or a Plan, not Pump"),
        (lambda: THREE.animate(RUN, frames_per_s=TEXT), "frames_per_s must be a number in 1/s, not str"),
        (lambda: THREE.animate(RUN, slower=TEXT), "slower must be a number in times the run, not str"),
    ],
)
def test_an_argument_of_a_picture_is_refused_by_its_name(call: Callable[[], Any], message: str) -> None:
    pytest.importorskip("matplotlib")
    with pytest.raises(TypeError) as raised:
        call()
    assert str(raised.value).startswith(message)


@pytest.mark.parametrize(
    ("keywords", "message"),
    [
        ({"limits": 3}, "limits must be a Limits, not int"),
        ({"smooth": "yes"}, "smooth must be True or False, not str"),
        ({"start_angle_rad": "1"}, "start_angle_rad must be a number in rad, not str"),
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
