import json
import math
import pickle

import numpy as np
import pytest

import pumpmodel as pm
from pumpmodel import choices


def known(value: float | None) -> float:
    """Return a value that only a pump with lines has."""
    assert value is not None
    return value


def test_25_ml_is_planned_to_the_nearest_step() -> None:
    pump = pm.Pump.three_roller()
    plan = pm.Doser(pump).plan("25mL", rate="10 mL/s")
    assert plan.pump is pump
    assert (plan.requested_ml, plan.steps, plan.steps_per_rev) == (25, 15_480, 12_800)
    assert plan.planned_ml == pytest.approx(pump.outlet_volume_ml(plan.end_angle_rad), abs=1e-12)
    assert abs(plan.planned_ml - 25) <= 0.5 * pump.outlet_flow_ml_rad(plan.end_angle_rad) * math.tau / 12_800
    assert plan.carry_ml == 25 - plan.planned_ml
    assert plan.end_angle_rad == pytest.approx(15_480 * math.tau / 12_800)
    assert plan.cruise_flow_ml_s == pytest.approx(10)
    assert plan.limited_by == "none"
    assert plan.cruise_speed_rpm == pytest.approx(pump.speed_for_flow_rpm(flow_ml_s=10))
    assert plan.mean_flow_ml_s == pytest.approx(plan.planned_ml / plan.motion_s)
    assert known(plan.settle_s) > 0
    assert plan.expanded_uncertainty_ml == pytest.approx(1.38, abs=0.01)
    assert plan.warnings == []


@pytest.mark.parametrize(
    ("text", "volume_ml"),
    [("0.025 L", 25), ("250uL", 0.25), ("250 µL", 0.25), ("25 g", 25 * 1.003839), ("-5mL", -5), ("1e3uL", 1)],
)
def test_a_volume_is_text_with_its_unit(text: str, volume_ml: float) -> None:
    plan = pm.Doser(pm.Pump.three_roller()).plan(text)
    # The factor of a balance in air, Z of ISO 8655-6, is tabled to 1e-4.
    assert plan.requested_ml == pytest.approx(volume_ml, rel=1e-5)
    assert plan.planned_ml == pytest.approx(volume_ml, abs=2e-3)
    assert np.sign(plan.steps) == np.sign(volume_ml)


@pytest.mark.parametrize("bad", [25, 25.0, b"25mL", None, np.float64(25), ["25mL"]])
def test_a_quantity_that_is_no_text_is_a_type_error(bad: str) -> None:
    doser = pm.Doser(pm.Pump.three_roller())
    with pytest.raises(TypeError, match='volume must be text with its unit, as "25mL", not '):
        doser.plan(bad)
    if bad is not None:
        for name in ("rate", "speed", "within"):
            with pytest.raises(TypeError, match=f"{name} must be text with its unit"):
                doser.plan("25mL", **{name: bad})  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("volume", "keywords", "message"),
    [
        ("25", {}, "`25` has no unit"),
        ("0mL", {}, "`0mL` is zero"),
        ("25ML", {}, "did you mean `mL`"),
        ("nan mL", {}, "is not a finite number"),
        ("25mL", {"rate": "100rpm"}, "unknown flow unit `rpm`, which is a speed unit"),
        ("25mL", {"speed": "-1rpm"}, "is negative"),
        ("25mL", {"within": "0s"}, "`0s` is zero"),
        ("25mL", {"rate": "5mL/s", "speed": "100rpm"}, "rate, speed and within exclude each other"),
        ("25mL", {"start_angle_rad": math.nan}, "start angle in rad is NaN"),
        ("25mL", {"carry_in_ml": math.inf}, "carry of earlier doses in mL is inf"),
        ("1000 L", {}, "volume in mL is 1000000; allowed: up to 100000"),
    ],
)
def test_a_bad_argument_is_a_value_error_that_names_it(
    volume: str, keywords: dict[str, object], message: str
) -> None:
    with pytest.raises(ValueError, match=message) as caught:
        pm.Doser(pm.Pump.three_roller()).plan(volume, **keywords)  # type: ignore[arg-type]
    assert not isinstance(caught.value, pm.PumpError)


@pytest.mark.parametrize(
    ("keywords", "limits", "message"),
    [
        ({"rate": "100mL/s"}, pm.Limits(), "limit of 170.00 r/min gives 60.402 mL/s at most"),
        ({"speed": "171rpm"}, pm.Limits(), "above the pump's limit of 170.00 r/min"),
        ({"within": "0.1s"}, pm.Limits(), "the fastest found takes"),
        (
            {"speed": "100rpm"},
            pm.Limits(max_outlet_kpa=100),
            "outlet pressure would reach .* above the limit",
        ),
        ({"speed": "100rpm"}, pm.Limits(min_inlet_kpa=80), "inlet pressure would fall to .* below the limit"),
    ],
)
def test_a_dose_that_the_pump_cannot_do_is_a_plan_error(
    keywords: dict[str, str], limits: pm.Limits, message: str
) -> None:
    with pytest.raises(pm.PlanError, match=message):
        pm.Doser(pm.Pump.three_roller(), limits).plan("25mL", **keywords)  # type: ignore[arg-type]


def test_less_than_half_a_step_is_a_plan_error() -> None:
    with pytest.raises(pm.PlanError, match="less than half a motor step"):
        pm.Doser(pm.Pump.three_roller()).plan("1nL")
    assert issubclass(pm.PlanError, pm.PumpError)
    assert not issubclass(pm.PlanError, ValueError)


def test_limits_that_mean_nothing_are_refused() -> None:
    with pytest.raises(ValueError, match=r"^max_outlet_kpa is -1; allowed: "):
        pm.Limits(max_outlet_kpa=-1)
    with pytest.raises(ValueError, match=r"^min_inlet_kpa is NaN; allowed: "):
        pm.Limits(min_inlet_kpa=math.nan)
    doser = pm.Doser(pm.Pump.three_roller(), pm.Limits(max_outlet_kpa=110, min_inlet_kpa=70))
    assert doser.limits == pm.Limits(max_outlet_kpa=110, min_inlet_kpa=70)
    plan = doser.plan("25mL", speed="100rpm")
    assert 70 < known(plan.inlet_min_kpa) < known(plan.inlet_max_kpa)
    assert known(plan.outlet_min_kpa) < known(plan.outlet_max_kpa) < 110


def test_the_cruise_is_a_rate_a_speed_a_time_or_the_pumps_default() -> None:
    doser = pm.Doser(pm.Pump.three_roller())
    assert doser.plan("25mL").cruise_flow_ml_s == pytest.approx(5)
    assert doser.plan("25mL", speed="100rpm").cruise_speed_rpm == pytest.approx(100)
    within = doser.plan("25mL", within="10s")
    assert within.motion_s + known(within.settle_s) <= 10
    assert within.motion_s + known(within.settle_s) > 9.9
    short = doser.plan("0.1mL", speed="170rpm")
    assert short.limited_by == "acceleration"
    assert short.cruise_speed_rpm < 170
    assert "too short" in short.warnings[0]


def test_start_angle_and_carry_are_counted() -> None:
    pump = pm.Pump.three_roller()
    doser = pm.Doser(pump)
    for start in np.linspace(-3, 7, 11):
        plan = doser.plan("2mL", start_angle_rad=start, carry_in_ml=0.5)
        moved = pump.outlet_volume_ml(plan.end_angle_rad) - pump.outlet_volume_ml(start)
        assert plan.start_angle_rad == start
        assert moved == pytest.approx(2.5, abs=2e-3)
        assert plan.planned_ml == pytest.approx(moved, abs=1e-12)
        assert plan.carry_ml == pytest.approx(2.5 - moved, abs=1e-12)
    owed = 0.0
    angle = 0.0
    for _ in range(50):
        plan = doser.plan("0.1mL", start_angle_rad=angle, carry_in_ml=owed)
        angle, owed = plan.end_angle_rad, plan.carry_ml
    assert pump.outlet_volume_ml(angle) + owed == pytest.approx(5, abs=1e-9)


def test_every_step_has_its_time() -> None:
    plan = pm.Doser(pm.Pump.three_roller()).plan("-25mL", rate="10 mL/s")
    times = plan.step_times_s
    assert times.shape == (-plan.steps,)
    assert times is plan.step_times_s
    assert not times.flags.writeable
    assert (np.diff(times) > 0).all()
    assert times[-1] == pytest.approx(plan.motion_s)
    # At the cruise speed the steps are evenly spaced.
    middle = np.diff(times)[len(times) // 2]
    assert 60 / (middle * plan.steps_per_rev) == pytest.approx(plan.cruise_speed_rpm, rel=1e-6)


def test_the_trace_covers_motion_and_settling() -> None:
    pump = pm.Pump.three_roller()
    plan = pm.Doser(pump).plan("25mL", rate="10 mL/s")
    trace = plan.trace()
    end_s = plan.motion_s + known(plan.settle_s)
    assert (trace.time_s[0], trace.time_s[-1]) == (0, end_s)
    assert plan.motion_s in trace.time_s
    assert (np.diff(trace.time_s) > 0).all()
    np.testing.assert_array_equal(trace.time_s[:1000], np.arange(1000) * 1e-3)
    assert trace.angle_rad[-1] == pytest.approx(plan.end_angle_rad)
    assert trace.delivered_ml[-1] == pytest.approx(plan.planned_ml, abs=1.1e-3)
    assert trace.speed_rad_s.max() == pytest.approx(plan.cruise_speed_rpm * math.tau / 60)
    fine = plan.trace(dt_s=1e-4)
    assert fine.outlet_kpa.max() == pytest.approx(plan.outlet_max_kpa, abs=1e-3)
    assert fine.inlet_kpa.min() == pytest.approx(plan.inlet_min_kpa, abs=1e-3)
    for bad in (0, -1, math.nan, math.inf, 1e-12):
        with pytest.raises(ValueError, match="dt_s is"):
            plan.trace(dt_s=bad)


def test_a_plan_as_a_dict_is_the_commands_dry_run() -> None:
    plan = pm.Doser(pm.Pump.three_roller(), pm.Limits(max_outlet_kpa=200)).plan("25mL", rate="10 mL/s")
    report = plan.to_dict()
    assert json.loads(json.dumps(report)) == report
    assert (report["schema"], report["pump"], report["completed"]) == ("dose/1", "three-roller", False)
    assert report["delivered_ml"] is None
    assert report["limits_not_checked"] == ["torque"], "the inlet is kept above collapse and vapour"
    assert report["end_angle_deg"] == pytest.approx(math.degrees(plan.end_angle_rad))
    assert (plan.retract_steps, plan.retraction_ml) == (0, 0), "None in the report"
    for name in report.keys() & set(dir(plan)) - {"pump", "retract_steps", "retraction_ml"}:
        value = report[name]
        # A ripple is a pair in Python.
        value = tuple(value.values()) if isinstance(value, dict) else value
        assert value == getattr(plan, name), name


def test_an_unknown_angle_gives_the_range_of_the_volume() -> None:
    pump = pm.Pump.three_roller()
    doser = pm.Doser(pump)
    known = doser.plan("25mL")
    assert (known.volume_least_ml, known.volume_most_ml) == (known.planned_ml, known.planned_ml)
    assert known.start_half_width_rad == 0
    plan = doser.plan("25mL", start_half_width_rad=math.pi)
    turn_rad = plan.end_angle_rad - plan.start_angle_rad
    start_rad = np.linspace(0, math.tau, 10_000)
    volume_ml = pump.outlet_volume_ml(start_rad + turn_rad) - pump.outlet_volume_ml(start_rad)
    assert plan.volume_least_ml == pytest.approx(volume_ml.min(), abs=1e-3)
    assert plan.volume_most_ml == pytest.approx(volume_ml.max(), abs=1e-3)
    assert plan.planned_ml == pytest.approx((plan.volume_least_ml + plan.volume_most_ml) / 2)
    assert "exact at any angle" in plan.warnings[1]
    assert pickle.loads(pickle.dumps(plan)) == plan
    with pytest.raises(ValueError, match="half width of the start angle"):
        doser.plan("25mL", start_half_width_rad=-1)


def test_a_dose_that_ends_at_low_flow_carries_the_difference() -> None:
    pump = pm.Pump.three_roller()
    doser = pm.Doser(pump)
    plan = doser.plan("25mL", finish="low-flow", start_angle_rad=0.3)
    end_rad = 0.3 + plan.steps * 2 * math.pi / 12800
    assert pump.outlet_flow_ml_rad(end_rad) <= 0.5 * pump.outlet_flow_ml_rad(1.5)
    assert plan.planned_ml + plan.carry_ml == pytest.approx(25)
    assert pickle.loads(pickle.dumps(plan)) == plan
    with pytest.raises(pm.PlanError, match="needs the rollers' angle"):
        doser.plan("25mL", finish="low-flow", start_half_width_rad=math.pi)
    with pytest.raises(ValueError, match="finish is 'dry'"):
        doser.plan("25mL", finish="dry")  # type: ignore[arg-type]


def test_a_smooth_flow_has_less_ripple_and_the_same_steps() -> None:
    doser = pm.Doser(pm.Pump.three_roller())
    even = doser.plan("25mL", rate="4 mL/s", start_angle_rad=0.3)
    smooth = doser.plan("25mL", rate="4 mL/s", smooth=True, start_angle_rad=0.3)
    assert (smooth.steps, smooth.carry_ml) == (even.steps, even.carry_ml)
    assert even.ripple_after == even.ripple_before == smooth.ripple_before
    assert smooth.ripple_after[0] < 0.035
    assert smooth.ripple_after[1] < 0.003
    assert smooth.cruise_flow_ml_s == pytest.approx(4)
    assert pickle.loads(pickle.dumps(smooth)) == smooth
    with pytest.raises(pm.PlanError, match="smooth flow needs the rollers' angle"):
        doser.plan("25mL", smooth=True, start_half_width_rad=math.pi)


def test_the_fastest_dose_is_limited_by_what_binds() -> None:
    pump = pm.Pump.three_roller()
    fastest = pm.Doser(pump).plan("60mL", rate="max")
    assert fastest.limited_by == "speed"
    held = pm.Doser(pump, pm.Limits(min_inlet_kpa=75)).plan("60mL", rate="max")
    assert held.limited_by == "inlet_suction"
    # A motor's step adds to what is predicted.
    assert 75 <= known(held.inlet_min_kpa) < 75.1
    assert pickle.loads(pickle.dumps(held)) == held


@pytest.mark.parametrize(
    ("volume", "limits", "limited_by"),
    [
        ("60mL", pm.Limits(max_outlet_kpa=100), "outlet_pressure"),
        ("60mL", pm.Limits(min_inlet_kpa=75), "inlet_suction"),
        ("-60mL", pm.Limits(max_outlet_kpa=100), "inlet_pressure"),
        ("-60mL", pm.Limits(min_inlet_kpa=75), "outlet_suction"),
    ],
)
def test_the_pressure_that_binds_is_named_by_its_port_and_its_side(
    volume: str, limits: pm.Limits, limited_by: choices.LimitedBy
) -> None:
    plan = pm.Doser(pm.Pump.three_roller(), limits).plan(volume, rate="max")
    assert plan.limited_by == limited_by
    at_limit = {
        "outlet_pressure": plan.outlet_max_kpa,
        "inlet_suction": plan.inlet_min_kpa,
        "inlet_pressure": plan.inlet_max_kpa,
        "outlet_suction": plan.outlet_min_kpa,
    }
    limit_kpa = limits.max_outlet_kpa or limits.min_inlet_kpa
    assert at_limit[limited_by] == pytest.approx(limit_kpa, abs=0.1)
