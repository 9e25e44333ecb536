import dataclasses
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pumpmodel as pm

DRAWING: dict[str, Any] = {
    "rollers": 3,
    "bore_radius_mm": 5.0,
    "tube_outer_radius_mm": 7.0,
    "backplate_radius_mm": 63.0,
    "contact_angle_deg": 30.0,
    "roller_radius_mm": 20.0,
    "roller_offset_mm": 40.0,
    "hose_length_mm": 331.0,
}
# Measured by McIntyre et al.
ANGLES = [0.0, 3.37, 6.92, 10.62, 13.98, 17.68, 21.20, 24.93, 28.50, 32.25, 35.75, 39.59, 42.87, 46.53, 50.53]
VOLUMES = [
    0.0,
    0.0207143,
    0.1057143,
    0.2528571,
    0.4357143,
    0.6842857,
    0.9007143,
    1.175,
    1.4014286,
    1.6157143,
    1.815,
    1.9542857,
    2.0242857,
    2.08,
    2.1064286,
]


def test_a_drawing_gives_a_pump_near_the_measured_one() -> None:
    pump = pm.Pump.from_drawing("bench-2", **DRAWING)
    assert pump.is_estimated
    assert pump.volume_per_revolution_ml == pytest.approx(21.3, rel=0.05)
    plan = pm.Doser(pump).plan("10mL")
    assert plan.to_dict()["volume_basis"] == "estimated"
    assert (
        plan.expanded_uncertainty_ml > pm.Doser(pm.Pump.three_roller()).plan("10mL").expanded_uncertainty_ml
    )


@pytest.mark.parametrize(
    "wrong",
    [{"rollers": 0}, {"rollers": -1}, {"rollers": 1}, {"bore_radius_mm": 7}, {"roller_offset_mm": np.nan}],
)
def test_a_drawing_of_no_pump_is_a_value_error(wrong: dict[str, float]) -> None:
    with pytest.raises(ValueError, match=r"allowed|roller|tube|NaN"):
        pm.Pump.from_drawing("bench-2", **{**DRAWING, **wrong})
    with pytest.raises(ValueError, match=r"\[pump\] id"):
        pm.Pump.from_drawing("Bench 2", **DRAWING)


@pytest.mark.parametrize("method", ["spline", "quintic"])
def test_measured_points_become_a_pump(method: Any) -> None:
    fit = pm.VolumeFit(np.array(ANGLES), VOLUMES, method=method)
    assert fit.engagement_deg == pytest.approx(50.53)
    assert fit.residuals_ml.shape == (15,)
    assert fit.rms_ml == pytest.approx(np.sqrt(np.mean(fit.residuals_ml**2)))
    pump = pm.Pump.three_roller().replace(roller_volume=fit, id="mine")
    assert (pump.id, pump.is_estimated) == ("mine", False)
    assert pump.roller_volume_ml == fit.total_ml
    assert pump.engagement_rad == pytest.approx(np.radians(50.53))
    assert pump != pm.Pump.three_roller().replace(id="mine")
    volumes = fit.displaced_ml(np.radians([-1, 0, 50.53, 60]))
    assert isinstance(volumes, np.ndarray)
    assert volumes.tolist() == [0, 0, fit.total_ml, fit.total_ml]
    assert dataclasses.replace(fit) == fit == pm.VolumeFit.from_dict(fit.to_dict())
    assert hash(dataclasses.replace(fit)) == hash(fit)


def test_points_that_fall_are_told() -> None:
    fit = pm.VolumeFit(ANGLES, [*VOLUMES[:8], VOLUMES[7] - 0.05, *VOLUMES[9:]])
    assert fit.falls is not None
    np.testing.assert_allclose(fit.falls, [[24.93, 28.50, 0.05]])
    assert len(fit.held_deg) == 1


@pytest.mark.parametrize(
    ("angles", "volumes", "method"),
    [
        ([0, 1], [0, 1], "spline"),
        ([0, 1, 2], [0, 1], "spline"),
        ([0, 1, 2], [0, 1, 2], "quintic"),
        (ANGLES, [np.nan] * 15, "spline"),
        ([ANGLES], [VOLUMES], "spline"),
        (ANGLES, VOLUMES, "septic"),
    ],
)
def test_points_without_a_curve_are_value_errors(angles: Any, volumes: Any, method: Any) -> None:
    with pytest.raises(ValueError, match=r"allowed|needed|points|angles"):
        pm.VolumeFit(angles, volumes, method=method)


def test_pumps_are_found_by_name_or_path(tmp_path: Path) -> None:
    assert pm.Pump.named("two-roller-as-built") == pm.Pump.two_roller("as-built")
    path = tmp_path / "bench.toml"
    path.write_text(pm.Pump.two_roller().to_toml())
    assert pm.Pump.named(str(path)) == pm.Pump.two_roller()
    with pytest.raises(pm.PumpFileError, match="built-in pumps: three-roller"):
        pm.Pump.named("four-roller")


def test_pumps_return_from_their_dicts() -> None:
    for pump in (pm.Pump.two_roller(), pm.Pump.from_drawing("bench-2", **DRAWING)):
        assert pm.Pump.from_dict(pump.to_dict()) == pump
    data = pm.Pump.three_roller().to_dict()
    data["motor"]["max_speed_rpm"] = 120.0
    assert pm.Pump.from_dict(data).max_speed_rpm == 120
    for wrong in (-1.0, float("nan"), "fast"):
        data["motor"]["max_speed_rpm"] = wrong
        with pytest.raises(pm.PumpFileError):
            pm.Pump.from_dict(data)
    with pytest.raises(pm.PumpFileError, match="unknown field"):
        pm.Pump.from_dict({**pm.Pump.three_roller().to_dict(), "colour": "red"})
    with pytest.raises(ValueError, match="roller_volume is 'guess'"):
        pm.Pump.three_roller().replace(roller_volume="guess")  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="roller_volume must be a VolumeFit, a VolumePolynomial or"):
        pm.Pump.three_roller().replace(roller_volume=2.1)  # type: ignore[arg-type]


def test_runs_of_a_table_become_a_fit_that_says_where_a_run_falls(tmp_path: Path) -> None:
    table = tmp_path / "runs.csv"
    rows = "a,0,0\nb,0,0\na,12,0.25\nb,12,0.2\na,25,0.84\nb,25,0.9\na,38,1.5\nb,38,0.88\na,50,1.6\nb,50,1.5\n"
    table.write_text(f"run,angle_deg,volume_ml\n{rows}")
    fit = pm.VolumeFit.from_csv(table)
    assert fit.run == ("a", "b") * 5
    [(run, *numbers)] = fit.run_falls
    assert run == "b"
    assert numbers == pytest.approx([25, 38, 0.02])
    assert pm.VolumeFit.from_dict(fit.to_dict()) == fit
    assert pickle.loads(pickle.dumps(fit)) == fit
    assert fit.total_ml == pm.VolumeFit(fit.angle_deg, fit.volume_ml).total_ml
    pump = pm.Pump.three_roller().replace(roller_volume=fit)
    assert pump.roller_volume_ml == pytest.approx(1.55)
    with pytest.raises(ValueError, match="run has 1 names; allowed: 10"):
        pm.VolumeFit(fit.angle_deg, fit.volume_ml, run=["a"])
    with pytest.raises(FileNotFoundError):
        pm.VolumeFit.from_csv(tmp_path / "none.csv")
    table.write_text("run,angle_deg\na,0\n")
    with pytest.raises(ValueError, match=r"runs.csv: line 2: volume_ml is missing"):
        pm.VolumeFit.from_csv(table)


def test_a_bought_head_needs_its_volume_and_its_rollers_alone() -> None:
    pump = pm.Pump.from_ml_per_rev("acid", ml_per_rev=0.5, rollers=4)
    assert pump.is_estimated
    assert (pump.outlet_volume_ml(1.0 + pump.pitch_rad) - pump.outlet_volume_ml(1.0)) == pytest.approx(
        0.125, rel=1e-12
    )
    plan = pm.Doser(pump).plan("5mL", start_angle_rad=0.0)
    assert plan.planned_ml == pytest.approx(5.0, abs=1e-3)
    assert plan.settle_s is None
    assert plan.outlet_max_kpa is None
    with pytest.raises(ValueError, match="known by its volume per revolution alone"):
        pump.roller_offset_mm  # noqa: B018
    line = pm.Line(
        resistance_kpa_s_ml=0.5, compliance_ml_kpa=0.01, inertance_kpa_s2_ml=0.02, reservoir_kpa=101.325
    )
    known = pm.Pump.from_ml_per_rev(
        "acid", ml_per_rev=0.5, rollers=4, tube_bore_mm=1.6, inlet=line, outlet=line
    )
    assert pm.Doser(known).plan("5mL", start_angle_rad=0.0).settle_s is not None
    assert pm.Pump.from_dict(known.to_dict()) == known
    with pytest.raises(ValueError, match="ml_per_rev is 0; allowed"):
        pm.Pump.from_ml_per_rev("acid", ml_per_rev=0.0, rollers=4)


def test_a_bought_head_that_cannot_be_is_refused_and_one_that_hardly_is_warned_of() -> None:
    # pi/4 1.6 mm² times 10 m are 20.1 mL.
    with pytest.raises(ValueError, match=r"0\.00337 to 20\.1 for this bore"):
        pm.Pump.from_ml_per_rev("acid", ml_per_rev=500.0, rollers=4, tube_bore_mm=1.6)
    with pytest.warns(UserWarning, match="40 rollers are more than heads have"):
        pm.Pump.from_ml_per_rev("acid", ml_per_rev=0.5, rollers=40)
    with pytest.warns(UserWarning, match="one roller seals the tube only"):
        pm.Pump.from_ml_per_rev("acid", ml_per_rev=0.5, rollers=1)
