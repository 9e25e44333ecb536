import math
import pickle
from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

import pumpmodel as pm

Array = NDArray[np.float64]


def integrated(
    pump: pm.Pump,
    speed_rad_s: Callable[[float], float],
    times_s: Array,
    start_rad: float = 0.0,
    state: pm.LineStates | None = None,
) -> Array:
    """Return pressures of inlet and outlet, kPa absolute, by SciPy on the circuit, in short steps."""
    inlet, outlet = pump.inlet, pump.outlet

    def slope(t: float, y: Array) -> list[float]:
        angle, pi, qi, po, qo = y.tolist()
        speed = speed_rad_s(t)
        return [
            speed,
            (qi - pump.inlet_flow_ml_rad(angle) * speed) / inlet.compliance_ml_kpa,
            (-pi - inlet.resistance_kpa_s_ml * qi) / inlet.inertance_kpa_s2_ml,
            (pump.outlet_flow_ml_rad(angle) * speed - qo) / outlet.compliance_ml_kpa,
            (po - outlet.resistance_kpa_s_ml * qo) / outlet.inertance_kpa_s2_ml,
        ]

    start = [start_rad, 0.0, 0.0, 0.0, 0.0]
    if state is not None:
        start[1:] = [
            state.inlet_kpa - inlet.reservoir_kpa,
            state.inlet_line_ml_s,
            state.outlet_kpa - outlet.reservoir_kpa,
            state.outlet_line_ml_s,
        ]
    run = solve_ivp(
        slope,
        (times_s[0], times_s[-1]),
        start,
        "DOP853",
        t_eval=times_s,
        rtol=1e-9,
        atol=1e-9,
        max_step=2e-3,
    )
    return np.stack([run.y[1] + inlet.reservoir_kpa, run.y[3] + outlet.reservoir_kpa])


def pressures(run: pm.Run) -> Array:
    return np.stack([run.inlet_kpa, run.outlet_kpa])


def test_times_that_are_given_have_the_pressures_of_the_grid() -> None:
    pump = pm.Pump.three_roller()
    grid = pump.simulate(speed_rpm=100, duration_s=1)
    some = np.array([0.0, 0.0131, 0.25, 0.777, 1.0])
    run = pump.simulate(speed_rpm=100, time_s=some)
    np.testing.assert_array_equal(run.time_s, some)
    at = pump.simulate(speed_rpm=100, time_s=grid.time_s)
    np.testing.assert_allclose(pressures(at), pressures(grid), atol=1e-10)
    np.testing.assert_allclose(at.delivered_ml, grid.delivered_ml, atol=1e-10)
    np.testing.assert_allclose(run.outlet_kpa[[0, 2, 4]], grid.outlet_kpa[[0, 250, 1000]], atol=1e-10)


def test_a_run_from_an_angle_is_that_of_a_head_which_stands_there() -> None:
    pump = pm.Pump.three_roller()
    angles = (0.7, -5.1)
    for start_rad in angles:
        run = pump.simulate(speed_rpm=-80, duration_s=0.5, start_angle_rad=start_rad)
        assert run.angle_rad[0] == start_rad
        assert run.delivered_ml[0] == 0
        np.testing.assert_array_equal(
            run.outlet_flow_ml_s, pump.outlet_flow_ml_rad(run.angle_rad) * run.speed_rad_s
        )
        turned = pump.simulate(speed_rpm=-80, duration_s=0.5, start_angle_rad=start_rad + pump.pitch_rad)
        np.testing.assert_allclose(pressures(turned), pressures(run), atol=1e-9)
        speed = run.speed_rad_s[0]
        peer = integrated(pump, lambda _, speed=speed: speed, run.time_s, start_rad)  # type: ignore[misc]
        np.testing.assert_allclose(pressures(run), peer, atol=1e-4)


def test_a_steady_start_repeats_itself_every_pitch_from_any_angle() -> None:
    pump = pm.Pump.three_roller()
    for speed_rpm in (100.0, -60.0):
        pitch_s = pump.pitch_rad / (abs(speed_rpm) * math.tau / 60)
        steady = pump.steady_state(speed_rpm=speed_rpm)
        for start_rad in (0.0, 1.1, -7.0):
            run = pump.simulate(
                speed_rpm=speed_rpm,
                duration_s=2 * pitch_s,
                dt_s=pitch_s / 500,
                initial="steady",
                start_angle_rad=start_rad,
            )
            first, again = pressures(run)[:, :501], pressures(run)[:, 500:]
            np.testing.assert_allclose(again, first, atol=1e-8)
            assert run.outlet_kpa.max() == pytest.approx(steady.outlet_max_kpa, abs=2e-3)
            assert run.inlet_kpa.min() == pytest.approx(steady.inlet_min_kpa, abs=2e-3)


@pytest.mark.parametrize("method", ["exact", "rodas5p", "radau"])
def test_a_run_goes_on_from_the_end_of_another(method: pm.choices.Method) -> None:
    pump = pm.Pump.three_roller()
    whole = pump.simulate(speed_rpm=100, duration_s=1.0, method=method)
    first = pump.simulate(speed_rpm=100, duration_s=0.4, method=method)
    assert first.end_state.outlet_kpa == pytest.approx(first.outlet_kpa[-1], abs=1e-9)
    rest = pump.simulate(
        speed_rpm=100,
        duration_s=0.6,
        method=method,
        initial=first.end_state,
        start_angle_rad=first.angle_rad[-1],
    )
    near = 1e-8 if method == "exact" else 2e-3
    np.testing.assert_allclose(pressures(rest), pressures(whole)[:, 400:], atol=near)
    np.testing.assert_allclose(
        first.delivered_ml[-1] + rest.delivered_ml, whole.delivered_ml[400:], atol=near
    )
    assert pickle.loads(pickle.dumps(first)).end_state == first.end_state
    with pytest.raises(AttributeError, match="from_dict has no end_state"):
        _ = pm.Run.from_dict(first.to_dict()).end_state


def test_speeds_at_knots_are_solved_exactly() -> None:
    pump = pm.Pump.three_roller()
    knots_s, speeds = np.array([-0.2, 0.1, 0.4, 0.9, 1.1]), np.array([0.0, 12.0, 12.0, -6.0, 0.0])
    output_s = np.linspace(-0.2, 1.1, 131)
    run = pump.simulate(time_s=knots_s, speed_rad_s=speeds, output_time_s=output_s, start_angle_rad=0.3)
    np.testing.assert_allclose(run.speed_rad_s, np.interp(output_s, knots_s, speeds), atol=1e-12)
    areas = np.concatenate([[0], np.cumsum(np.diff(knots_s) * (speeds[1:] + speeds[:-1]) / 2)])
    at_knots = pump.simulate(time_s=knots_s, speed_rad_s=speeds, start_angle_rad=0.3)
    np.testing.assert_array_equal(at_knots.time_s, knots_s)
    np.testing.assert_allclose(at_knots.angle_rad, 0.3 + areas, atol=1e-12)
    peer = integrated(pump, lambda t: float(np.interp(t, knots_s, speeds)), output_s, 0.3)
    np.testing.assert_allclose(pressures(run), peer, atol=1e-4)
    # Knots that lie on the lines change nothing but rounding.
    more_s = np.union1d(knots_s, output_s)
    finer = pump.simulate(
        time_s=more_s,
        speed_rad_s=np.interp(more_s, knots_s, speeds),
        output_time_s=output_s,
        start_angle_rad=0.3,
    )
    np.testing.assert_allclose(pressures(finer), pressures(run), atol=1e-9)
    integrator = pump.simulate(
        time_s=knots_s, speed_rad_s=speeds, output_time_s=output_s, start_angle_rad=0.3, method="rodas5p"
    )
    np.testing.assert_allclose(pressures(integrator), pressures(run), atol=1e-3)


def test_a_function_of_time_is_followed() -> None:
    pump = pm.Pump.three_roller()

    def speed_rad_s(t: float) -> float:
        return 8 + 5 * math.sin(7 * t)

    run = pump.simulate(speed_rad_s=speed_rad_s, duration_s=1.5, dt_s=0.01)
    np.testing.assert_allclose(run.speed_rad_s, 8 + 5 * np.sin(7 * run.time_s), atol=2e-5)
    np.testing.assert_allclose(
        run.angle_rad, 8 * run.time_s + 5 / 7 * (1 - np.cos(7 * run.time_s)), atol=1e-9
    )
    np.testing.assert_allclose(pressures(run), integrated(pump, speed_rad_s, run.time_s), atol=1e-4)
    by_rpm = pump.simulate(speed_rpm=lambda t: speed_rad_s(t) * 60 / math.tau, duration_s=1.5, dt_s=0.01)
    np.testing.assert_allclose(pressures(by_rpm), pressures(run), atol=1e-8)
    at = pump.simulate(speed_rad_s=speed_rad_s, time_s=run.time_s[::30])
    np.testing.assert_allclose(at.outlet_kpa, run.outlet_kpa[::30], atol=1e-5)


def test_a_function_that_jumps_is_followed_as_its_pieces_are() -> None:
    pump = pm.Pump.three_roller()
    jump_s = 0.1234567
    run = pump.simulate(speed_rad_s=lambda t: 10.0 if t < jump_s else 0.0, duration_s=0.5)
    turned = pump.simulate(speed_rad_s=10.0, time_s=[0.0, jump_s])
    times = run.time_s[run.time_s > jump_s]
    rest = pump.simulate(
        time_s=[jump_s, 1.0],
        speed_rad_s=[0.0, 0.0],
        output_time_s=times,
        initial=turned.end_state or "rest",
        start_angle_rad=turned.angle_rad[-1],
    )
    np.testing.assert_allclose(run.outlet_kpa[-len(times) :], rest.outlet_kpa, atol=1e-6)
    assert run.angle_rad[-1] == pytest.approx(10 * jump_s, abs=1e-8)


def test_an_error_of_a_function_is_raised_and_a_wild_one_is_refused() -> None:
    pump = pm.Pump.three_roller()

    def fails(t: float) -> float:
        raise LookupError(f"no speed at {t}")

    with pytest.raises(LookupError, match="no speed"):
        pump.simulate(speed_rpm=fails, duration_s=1)
    with pytest.raises(ValueError, match=r"speed_rpm at .* s is NaN; allowed: a finite number"):
        pump.simulate(speed_rpm=lambda _: math.nan, duration_s=1)


def test_hoses_start_in_their_own_steady_state() -> None:
    pump = pm.Pump.three_roller()
    data = pump.to_dict()
    hose = {
        "bore_radius_mm": 5.0,
        "outer_radius_mm": 7.0,
        "length_mm": 331.0,
        "modulus_mpa": 3.5,
        "poisson_ratio": 0.5,
        "minor_loss": 5.75,
        "resistance_at_ml_s": 210.0,
    }
    for port in ("inlet", "outlet"):
        for name in ("resistance_kpa_s_ml", "compliance_ml_kpa", "inertance_kpa_s2_ml"):
            del data[port][name]
        data[port]["hose"] = hose
    pump = pm.Pump.from_dict(data)
    pitch_s = pump.pitch_rad / 10
    run = pump.simulate(
        speed_rad_s=10, duration_s=2 * pitch_s, dt_s=pitch_s / 100, initial="steady", start_angle_rad=0.8
    )
    np.testing.assert_allclose(pressures(run)[:, 100:], pressures(run)[:, :101], atol=2e-3)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"speed_rpm": 1}, "no time is given; give duration_s or time_s"),
        ({"speed_rpm": 1, "duration_s": 1, "time_s": [0, 1]}, "time_s and duration_s are both given"),
        ({"speed_rpm": 1, "dt_s": 1, "time_s": [0, 1]}, "dt_s is given, but time_s has the times"),
        ({"speed_rpm": 1, "time_s": [0, 1], "output_time_s": [0]}, "output_time_s is given, but the speed"),
        ({"speed_rpm": 1, "time_s": [-1, 1]}, "time_s has -1 s; allowed: 0 to 10000000 s"),
        ({"speed_rpm": 1, "time_s": [0, 1, 1]}, "time_s has 1 s after 1 s; allowed: times that rise"),
        ({"speed_rpm": 1, "time_s": [0, math.nan]}, "time_s has NaN s"),
        ({"speed_rpm": 1, "time_s": 1.0}, "time_s is one number; allowed: times of shape"),
        ({"speed_rpm": 1, "time_s": []}, "allowed: .n,., one time at least"),
        ({"speed_rpm": [1, 2], "duration_s": 1}, "give the times of these speeds as time_s"),
        ({"speed_rpm": [1, 2], "time_s": [0, 1], "dt_s": 1}, "duration_s and dt_s do not go with"),
        ({"speed_rpm": [1, 2], "time_s": [0, 1, 2]}, "time_s has 3 times and the speed 2 numbers"),
        ({"speed_rpm": [[1, 2]], "time_s": [0, 1]}, "the speed has shape .1, 2.; allowed: one number"),
        (
            {"speed_rpm": [1, 2], "time_s": [0, 1], "output_time_s": [0, 2]},
            "output_time_s has 2 s; allowed: 0 to 1",
        ),
        ({"speed_rpm": 1, "duration_s": 1, "start_angle_rad": math.inf}, "start_angle_rad is inf"),
        ({"speed_rpm": [0, 1], "time_s": [0, 1], "initial": "steady"}, "the speed at the start is 0"),
        ({"speed_rpm": 1, "duration_s": 1, "initial": (1, 2, math.nan, 3)}, "outlet_kpa of initial is NaN"),
        (
            {"speed_rpm": 1, "duration_s": 1, "initial": "steady", "model": "roller-centric"},
            "the roller-centric model starts from lines at rest",
        ),
    ],
)
def test_a_motion_that_is_no_motion_is_refused(arguments: dict[str, object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        pm.Pump.three_roller().simulate(**arguments)  # type: ignore[call-overload]


def test_a_state_of_other_numbers_is_a_type_error() -> None:
    with pytest.raises(TypeError, match="initial must be 'rest', 'steady' or a LineStates of four numbers"):
        pm.Pump.three_roller().simulate(speed_rpm=1, duration_s=1, initial=(1.0, 2.0))  # type: ignore[call-overload]


def test_a_speed_that_varies_needs_volumes_that_do_not() -> None:
    data = pm.Pump.three_roller().to_dict()
    data["speed_law"] = {
        "kind": "inlet-pressure",
        "s": 0.953,
        "d_per_kpa": 2.05e-3,
        "least_rpm": 10,
        "most_rpm": 170,
        "residual_percent": 2.4,
    }
    pump = pm.Pump.from_dict(data)
    assert len(pump.simulate(speed_rpm=100, time_s=[0, 1])) == 2
    with pytest.raises(ValueError, match="the volumes of this pump depend on the speed"):
        pump.simulate(speed_rpm=[20, 30], time_s=[0, 1])


def test_a_jump_of_the_speed_is_told_how_to_be_given() -> None:
    pump = pm.Pump.three_roller()
    with pytest.raises(ValueError, match=r"a jump of the speed as two times with a gap of 1e-9 s"):
        pump.simulate(speed_rpm=[50, 50, 100, 100], time_s=[0, 0.5, 0.5, 1])
    run = pump.simulate(
        speed_rpm=[50, 50, 100, 100], time_s=[0, 0.5, 0.5 + 1e-9, 1], output_time_s=[0, 0.4, 0.6]
    )
    assert run.speed_rad_s[2] == pytest.approx(2 * run.speed_rad_s[1])
