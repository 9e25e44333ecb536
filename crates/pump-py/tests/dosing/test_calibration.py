import pickle
from pathlib import Path

import numpy as np
import pytest

import pumpmodel as pm

PUMP = pm.Pump.three_roller()
REVOLUTION_ML = PUMP.volume_per_revolution_ml


def runs(*factors: tuple[float, float]) -> list[pm.WeighedRun]:
    return [
        pm.WeighedRun(speed_rpm=speed, turned_deg=720, volume_ml=2 * REVOLUTION_ML * factor)
        for speed, factor in factors
    ]


def test_a_line_through_runs_is_found_and_doses_use_it() -> None:
    found = pm.Calibration.from_runs(PUMP, runs((20, 0.98), (60, 1.0), (100, 1.02), (20, 0.98), (100, 1.02)))
    assert found.displacement_factor(speed_rpm=60) == pytest.approx(1)
    np.testing.assert_allclose(found.displacement_factor(speed_rpm=[[20, 100]]), [[0.98, 1.02]])
    assert found.standard_uncertainty(speed_rpm=60) < 1e-3
    assert found.speeds_rpm == pytest.approx([20, 60, 100])
    plain, calibrated = (pm.Doser(PUMP, calibration=of).plan("100mL", speed="100rpm") for of in (None, found))
    assert calibrated.steps == pytest.approx(plain.steps / 1.02, rel=5e-3)
    assert calibrated.planned_ml == pytest.approx(100, abs=3e-3)
    assert calibrated.expanded_uncertainty_ml < plain.expanded_uncertainty_ml
    assert calibrated.to_dict()["volume_basis"] == "calibrated"
    shares = {share["source"]: share["standard_ml"] for share in calibrated.uncertainty_budget}
    assert shares["model"] == 0
    assert shares["repeatability"] > 0
    trace = calibrated.trace()
    assert trace.delivered_ml[-1] == pytest.approx(100, abs=4e-3)
    with pytest.raises(pm.PlanError, match=r"calibration 0 holds from 20\.0000 to 100\.0000 r/min"):
        pm.Doser(PUMP, calibration=found).plan("100mL", speed="150rpm")


def test_a_calibration_of_another_pump_is_refused() -> None:
    found = pm.Calibration.from_runs(pm.Pump.two_roller(), runs((60, 1.08)))
    with pytest.raises(pm.PlanError, match="calibrate again"):
        pm.Doser(PUMP, calibration=found).plan("10mL")


def test_masses_of_a_table_are_volumes(tmp_path: Path) -> None:
    table = tmp_path / "runs.csv"
    table.write_text("speed_rpm,revolutions,mass_g\n60,2,42.4\n60,2,42.5\n")
    found = pm.Calibration.from_csv(PUMP, table, scale="0.01g")
    by_hand = [
        pm.WeighedRun(speed_rpm=60, turned_deg=720).weighed(reading) for reading in ("42.4g", "42.5 g")
    ]
    same = pm.Calibration.from_runs(PUMP, by_hand, scale="0.01g")
    assert found.displacement_factor(speed_rpm=60) == same.displacement_factor(speed_rpm=60)
    assert found.displacement_factor(speed_rpm=60) == pytest.approx(42.45 / 0.997 / 42.637, abs=2e-3)
    table.write_text("speed_rpm,revolutions,mass_g\n60,2,-1\n")
    with pytest.raises(ValueError, match=r"runs.csv: line 2: mass_g is -1"):
        pm.Calibration.from_csv(PUMP, table)
    with pytest.raises(FileNotFoundError):
        pm.Calibration.from_csv(PUMP, tmp_path / "none.csv")


@pytest.mark.parametrize(
    ("made", "message"),
    [
        (lambda: pm.WeighedRun(speed_rpm=0, turned_deg=1), "speed_rpm is 0"),
        (lambda: pm.WeighedRun(speed_rpm=1, turned_deg=0), "turned_deg is 0"),
        (lambda: pm.WeighedRun(speed_rpm=1, turned_deg=1, mass_g=1, volume_ml=1), "both given"),
        (lambda: pm.WeighedRun(speed_rpm=1, turned_deg=1, mass_g=-1), "mass_g is -1"),
        (lambda: pm.ShortDose(start_angle_deg=0, turned_deg=9, volume_ml=0), "volume_ml is 0"),
        (lambda: pm.Calibration.from_runs(PUMP, []), "1 at least"),
        (lambda: pm.Calibration.from_runs(PUMP, [pm.WeighedRun(speed_rpm=1, turned_deg=1)]), "no reading"),
        (lambda: pm.Calibration.from_runs(PUMP, runs((60, 3.0))), "a mistake in a unit"),
        (lambda: pm.Calibration.from_runs(PUMP, runs((60, 1.0)), scale="-1g"), "scale is negative"),
        (
            lambda: pm.Calibration.from_dict({"schema": "calibration/1"}),
            "version is missing; allowed: 0 or a bench's number",
        ),
    ],
)
def test_readings_that_cannot_be_right_are_value_errors(made: object, message: str) -> None:
    assert callable(made)
    with pytest.raises(ValueError, match=message):
        made()


def test_calibrations_are_values() -> None:
    one = pm.Calibration.from_runs(PUMP, runs((60, 1.01)))
    again = pm.Calibration.from_dict(one.to_dict())
    assert again == one
    assert hash(again) == hash(one)
    assert pickle.loads(pickle.dumps(one)) == one
    assert one != pm.Calibration.from_runs(PUMP, runs((60, 1.02)))
    assert repr(one).startswith("<Calibration 0 of 20")
    doser = pm.Doser(PUMP, calibration=one)
    assert pickle.loads(pickle.dumps(doser)) == doser
    plan = doser.plan("10mL", speed="60rpm", retract="0.1mL")
    assert pickle.loads(pickle.dumps(plan)) == plan
    assert plan != pm.Doser(PUMP).plan("10mL", speed="60rpm", retract="0.1mL")


def test_a_bench_keeps_calibrations_and_uses_one(tmp_path: Path) -> None:
    with pm.Bench.open("three-roller", state_dir=tmp_path) as bench:
        assert bench.calibration is None
        made = [
            bench.calibration_run(speed_rpm=speed, pitches=3) for speed in (20, 60, 100) for _ in range(2)
        ]
        assert made[0].turned_deg == pytest.approx(360, abs=0.05)
        first = bench.calibrate(
            [run.weighed(f"{1.01 * REVOLUTION_ML}mL") for run in made], scale="0.01mL", tube="A", note="new"
        )
        assert (first.version, first.tube, first.note) == (1, "A", "new")
        assert bench.calibration == first
        dose = bench.dose("25mL", rate="20mL/s")
        assert dose.calibration is not None
        assert dose.calibration.version == 1
        assert dose.volume_basis == "calibrated"
        assert dose.calibration.displacement_factor == pytest.approx(1.01, abs=1e-3)
        allowed = "fit is 'cubic'; allowed: 'best', 'line', 'factor', 'speed-law'"
        with pytest.raises(ValueError, match=allowed):
            bench.calibrate(runs((60, 1.02)), fit="cubic")  # type: ignore[arg-type]
        with pytest.raises(ValueError, match="3"):
            bench.calibrate(runs((60, 1.02)), fit="speed-law")
        second = bench.calibrate(runs((60, 1.02)))
        assert bench.calibrations() == [first, second]
        bench.use_calibration(1)
        assert bench.calibration == first
        bench.use_calibration(None)
        assert bench.calibration is None
        with pytest.raises(ValueError, match="no calibration 3"):
            bench.use_calibration(3)
        with pytest.raises(ValueError, match="speed_rpm is 0; allowed: a speed of more than 0"):
            bench.calibration_run(speed_rpm=0, pitches=1)


def test_short_doses_find_the_zero(tmp_path: Path) -> None:
    shifted = 0.1
    starts = np.radians(np.arange(0, 120, 6))
    volumes = PUMP.outlet_volume_ml(starts + shifted + np.radians(24)) - PUMP.outlet_volume_ml(
        starts + shifted
    )
    doses = [
        pm.ShortDose(start_angle_deg=float(np.degrees(start)), turned_deg=24, volume_ml=float(volume))
        for start, volume in zip(starts, volumes, strict=True)
    ]
    with pm.Bench.open("three-roller", state_dir=tmp_path) as bench:
        found = bench.calibrate_phase(doses)
        assert found.zero_rad == pytest.approx(shifted, abs=1e-6)
        assert found.roller_volume_ml == pytest.approx(PUMP.roller_volume_ml, rel=1e-6)
        assert found.engagement_rad == pytest.approx(PUMP.engagement_rad, rel=1e-6)
        assert bench.calibration == found.calibration
        assert found.calibration.zero_rad == pytest.approx(shifted, abs=1e-6)


def test_a_run_to_be_weighed_tells_its_warnings(tmp_path: Path) -> None:
    with pm.Bench.open(PUMP, state_dir=tmp_path) as bench:
        run = bench.calibration_run(speed_rpm=150, pitches=3)
        assert any("the prediction is uncertain by" in warning for warning in run.warnings)
        assert pm.WeighedRun.from_dict(run.to_dict()) == run
        assert bench.calibrate([run.weighed("21.3mL")]).version == 1
    with pm.Bench.open(pm.Pump.two_roller(), state_dir=tmp_path) as bench:
        assert bench.calibration_run(speed_rpm=60, pitches=3).warnings == ()


def test_the_weight_of_the_last_dose_calibrates_the_next(tmp_path: Path) -> None:
    with pm.Bench.open("three-roller", state_dir=tmp_path) as bench:
        with pytest.raises(ValueError, match=r"no dose is on record.*bench\.calibrate_last"):
            bench.calibrate_last("10g")
        # Half a revolution scatters so much that the model is surer: the weighing waits.
        bench.dose("10mL")
        bench.calibrate_last("10.20mL")
        assert bench.dose("100mL").volume_basis == "model"
        found = bench.calibrate_last("102.00mL", anew=True)
        assert found.displacement_factor(speed_rpm=14) == pytest.approx(1.02, abs=1e-4)
        dose = bench.dose("10mL")
        assert dose.volume_basis == "calibrated"
        # One weighed dose shows no scatter: a prior of 3 degrees of freedom stands for it.
        priors = {share.source: share.prior for share in dose.uncertainty_budget if share.prior is not None}
        assert set(priors) == {"repeatability", "calibration"}
        assert (priors["repeatability"].weighed, priors["repeatability"].degrees_of_freedom) == (1, 3)
        assert type(dose).from_dict(dose.to_dict()) == dose
        bench.calibrate_last("10.00mL", anew=True)
        with pytest.raises(ValueError, match="exclude each other"):
            bench.calibrate_last("10.00mL", add=True, anew=True)


def test_a_dose_is_weighed_as_the_fluid_that_it_was_made_with(tmp_path: Path) -> None:
    with pm.Bench.open(
        "three-roller", state_dir=tmp_path, fluid="glycerol 60%", temperature="22degC"
    ) as bench:
        bench.dose("213mL")
    with pm.Bench.open("three-roller", state_dir=tmp_path) as bench:
        found = bench.calibrate_last("245.5g")
        assert (found.fluid, found.temperature_degc) == ("glycerol 60%", 22.0)
        assert bench.log()[0].fluid == "glycerol 60%"
    with pm.Bench.open("three-roller", state_dir=tmp_path, fluid="ethanol") as bench:
        found = bench.calibrate_last("168.0g", anew=True)
        assert (found.fluid, found.temperature_degc) == ("ethanol", 22.0)
