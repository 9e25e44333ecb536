import math

import control
import numpy as np
import pytest
from scipy import signal

import pumpmodel as pm

PORTS: tuple[pm.choices.Port, ...] = ("inlet", "outlet")


@pytest.mark.parametrize("port", PORTS)
def test_scipy_takes_the_line_and_its_step_is_that_of_a_line(port: pm.choices.Port) -> None:
    line = pm.Pump.three_roller().outlet
    space = signal.StateSpace(*line.state_space(port))
    _, stepped_kpa = signal.step(space, T=np.linspace(0, 5, 1000))
    transfer = signal.TransferFunction(*line.transfer_function(port))
    rad_s = np.geomspace(0.1, 1e4, 60)
    # SciPy's own way from matrices to a response warns of a numerator whose first coefficient is 0.
    a, b, c, d = line.state_space(port)
    by_space = np.array([(c @ np.linalg.solve(1j * w * np.eye(2) - a, b) + d)[0, 0] for w in rad_s])
    by_transfer = signal.freqresp(transfer, rad_s)[1]
    np.testing.assert_allclose(by_space, by_transfer, rtol=1e-9, atol=1e-12)
    sign = 1 if port == "outlet" else -1
    assert by_transfer[0].real == pytest.approx(sign * line.resistance_kpa_s_ml, rel=1e-3)
    # The poles are those of the oscillator.
    natural = 1 / math.sqrt(line.inertance_kpa_s2_ml * line.compliance_ml_kpa)
    np.testing.assert_allclose(np.abs(np.linalg.eigvals(a)), natural)
    assert stepped_kpa[-1] == pytest.approx(sign * line.resistance_kpa_s_ml, rel=1e-6)


@pytest.mark.parametrize("port", PORTS)
def test_scipys_response_to_the_flow_is_the_simulated_pressure(port: pm.choices.Port) -> None:
    pump = pm.Pump.three_roller()
    run = pump.simulate(speed_rpm=100, duration_s=1, dt_s=1e-4)
    line = getattr(pump, port)
    flow_ml_s = getattr(run, f"{port}_flow_ml_s")
    _, above_kpa, _ = signal.lsim(signal.StateSpace(*line.state_space(port)), flow_ml_s, run.time_s)
    # lsim takes the flow as straight between the samples, also where it jumps.
    np.testing.assert_allclose(above_kpa + line.reservoir_kpa, getattr(run, f"{port}_kpa"), atol=3e-3)


@pytest.mark.parametrize("port", PORTS)
def test_python_control_takes_the_line_and_simulates_the_pressure(port: pm.choices.Port) -> None:
    pump = pm.Pump.three_roller()
    line = getattr(pump, port)
    space, transfer = control.ss(*line.state_space(port)), control.tf(*line.transfer_function(port))
    rad_s = np.geomspace(0.1, 1e4, 60)
    expected = signal.freqresp(signal.TransferFunction(*line.transfer_function(port)), rad_s)[1]
    for system in (space, transfer):
        np.testing.assert_allclose(system(1j * rad_s), expected, rtol=1e-9, atol=1e-12)
        np.testing.assert_allclose(np.sort(system.poles()), np.sort(np.linalg.eigvals(space.A)))
    sign = 1 if port == "outlet" else -1
    assert control.dcgain(space) == pytest.approx(sign * line.resistance_kpa_s_ml)
    run = pump.simulate(speed_rpm=100, duration_s=1, dt_s=1e-4)
    flow_ml_s = getattr(run, f"{port}_flow_ml_s")
    above_kpa = control.forced_response(space, run.time_s, flow_ml_s).outputs
    # The flow is taken as straight between the samples, also where it jumps.
    np.testing.assert_allclose(above_kpa + line.reservoir_kpa, getattr(run, f"{port}_kpa"), atol=3e-3)


@pytest.mark.parametrize("port", PORTS)
@pytest.mark.parametrize("speed_rpm", [100.0, -40.0])
def test_harmonics_add_up_to_the_steady_state(port: pm.choices.Port, speed_rpm: float) -> None:
    pump = pm.Pump.three_roller()
    found = pump.harmonics(400, speed_rpm=speed_rpm, port=port)
    pitch_s = math.tau / found.rad_s[0]
    run = pump.simulate(speed_rpm=speed_rpm, duration_s=pitch_s, dt_s=pitch_s / 300, initial="steady")
    waves = np.exp(1j * np.outer(run.time_s, found.rad_s))
    pressure_kpa = found.mean_kpa + (waves @ found.pressure_kpa).real
    # The measured volume makes the flow jump where a pitch begins, and a little where a roller has left. The
    # pressure has corners there.
    np.testing.assert_allclose(pressure_kpa, getattr(run, f"{port}_kpa"), atol=2e-3)
    np.testing.assert_allclose(pressure_kpa[5:-5], getattr(run, f"{port}_kpa")[5:-5], atol=1e-4)
    steady = pump.steady_state(speed_rpm=speed_rpm)
    assert found.mean_kpa == pytest.approx(getattr(steady, f"{port}_mean_kpa"), abs=1e-9)
    transfer = signal.TransferFunction(*getattr(pump, port).transfer_function(port))
    response = signal.freqresp(transfer, found.rad_s)[1]
    np.testing.assert_allclose(found.pressure_kpa, response * found.flow_ml_s, rtol=1e-9)


def test_harmonics_are_those_of_a_fine_fourier_sum() -> None:
    pump = pm.Pump.three_roller()
    found = pump.harmonics(6, speed_rad_s=1.0)
    count = 1 << 16
    angles = np.arange(count) * pump.pitch_rad / count
    sums = 2 * np.fft.rfft(pump.outlet_flow_ml_rad(angles))[1:7] / count
    # The sum takes a jump at angle 0 for a straight line between two samples.
    np.testing.assert_allclose(found.flow_ml_s.imag, sums.imag, atol=1e-8)
    np.testing.assert_allclose(found.flow_ml_s.real, sums.real, atol=3e-6)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"count": 0}, "count is 0; allowed: 1 to 10000"),
        ({"count": 10_001}, "count is 10001"),
        ({"speed_rpm": 0}, "speed_rpm is 0; allowed: a finite speed other than 0"),
        ({"speed_rpm": [1, 2]}, "allowed: one number"),
        ({"port": "side"}, "port is 'side'; allowed: 'inlet', 'outlet'"),
    ],
)
def test_harmonics_of_nothing_are_refused(arguments: dict[str, object], message: str) -> None:
    given: dict[str, object] = {"count": 5, "speed_rpm": 100, **arguments}
    with pytest.raises(ValueError, match=message):
        pm.Pump.three_roller().harmonics(**given)  # type: ignore[call-overload]
    for refused in (
        pm.Pump.three_roller().outlet.state_space,
        pm.Pump.three_roller().outlet.transfer_function,
    ):
        with pytest.raises(ValueError, match="port is 'side'"):
            refused("side")  # type: ignore[arg-type]
