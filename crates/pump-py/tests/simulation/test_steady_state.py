import numpy as np
import pytest

import pumpmodel as pm

NAMES = (
    "inlet_min_kpa",
    "inlet_max_kpa",
    "inlet_mean_kpa",
    "outlet_min_kpa",
    "outlet_max_kpa",
    "outlet_mean_kpa",
    "mean_flow_ml_s",
    "ripple_peak_to_peak",
    "ripple_rms",
)

# Rollers, r/min, and max, min, mean of the inlet and of the outlet, kPa.
REFERENCE = [
    (3, 50, (90.5879, 84.8782, 86.6686), (93.3473, 87.8604, 90.6054)),
    (3, 100, (95.3347, 73.7963, 84.7002), (104.5105, 83.5685, 92.5738)),
    (3, 150, (100.3254, 61.4112, 82.7318), (116.2201, 77.4455, 94.5422)),
    (2, 50, (90.5578, 84.8847, 86.4742), (93.3369, 87.8931, 90.7998)),
    (2, 100, (96.3518, 73.0388, 84.3114), (105.3520, 82.4483, 92.9626)),
    (2, 150, (99.8906, 61.0270, 82.1486), (116.6113, 78.3548, 95.1254)),
]


@pytest.mark.parametrize(("rollers", "speed_rpm", "inlet", "outlet"), REFERENCE)
def test_pressures_are_those_of_the_reference(
    rollers: int, speed_rpm: float, inlet: tuple[float, ...], outlet: tuple[float, ...]
) -> None:
    steady = pm.Pump.three_roller().replace(rollers=rollers).steady_state(speed_rpm=speed_rpm)
    found = (steady.inlet_max_kpa, steady.inlet_min_kpa, steady.inlet_mean_kpa)
    assert found == pytest.approx(inlet, abs=2e-3)
    found = (steady.outlet_max_kpa, steady.outlet_min_kpa, steady.outlet_mean_kpa)
    assert found == pytest.approx(outlet, abs=2e-3)


def test_flow_and_ripple_of_one_speed_are_floats() -> None:
    pump = pm.Pump.three_roller()
    steady = pump.steady_state(speed_rpm=100)
    assert all(type(getattr(steady, name)) is float for name in NAMES)
    assert steady.mean_flow_ml_s == pump.average_flow_ml_s(speed_rpm=100)
    assert steady.ripple_peak_to_peak == pytest.approx(1.18, abs=5e-3)
    assert steady.ripple_rms == pytest.approx(0.427, abs=5e-4)


def test_arrays_of_speeds_give_read_only_arrays_of_their_shape() -> None:
    pump = pm.Pump.three_roller()
    speeds = np.array([[50, 100, 150], [-50, 20, 60]])
    steady = pump.steady_state(speed_rpm=speeds)
    for name in NAMES:
        values = getattr(steady, name)
        assert values.dtype == np.float64
        assert values is getattr(steady, name)
        assert not values.flags.writeable
        alone = [getattr(pump.steady_state(speed_rpm=float(speed)), name) for speed in speeds.flat]
        np.testing.assert_array_equal(values, np.reshape(alone, speeds.shape))
    assert pump.steady_state(speed_rad_s=[]).inlet_min_kpa.shape == (0,)


def test_a_speed_of_zero_is_refused() -> None:
    with pytest.raises(ValueError, match="speed_rpm is 0; allowed: a finite speed other than 0"):
        pm.Pump.three_roller().steady_state(speed_rpm=[100, 0])


def test_an_undamped_line_at_resonance_is_refused() -> None:
    pump = pm.Pump.three_roller()
    line = pm.Line(
        resistance_kpa_s_ml=0, compliance_ml_kpa=0.04, inertance_kpa_s2_ml=0.0064, reservoir_kpa=88.0
    )
    # Natural frequency 62.5 rad/s; three pulses a revolution.
    with pytest.raises(ValueError, match="resonance of the outlet line"):
        pump.replace(outlet=line).steady_state(speed_rad_s=62.5 / 3)


def test_the_end_of_a_long_run_is_the_steady_state() -> None:
    pump = pm.Pump.three_roller()
    run = pump.simulate(speed_rpm=100, duration_s=10)
    steady = pump.steady_state(speed_rpm=100)
    late = run.time_s > 5
    assert run.outlet_kpa[late].max() == pytest.approx(steady.outlet_max_kpa, abs=0.02)
    assert run.inlet_kpa[late].min() == pytest.approx(steady.inlet_min_kpa, abs=0.02)
