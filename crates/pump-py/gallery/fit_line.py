"""Resistance, compliance and inertance of an outlet line from a measured pressure waveform.

The measurement is simulated: the model at 100 r/min from rest, read every 2 ms, with white noise of 0.3 kPa.
The fit starts a factor of two away. Whoever has a waveform puts it in place of `measure`.
"""

import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np
from matplotlib import pyplot as plt
from numpy.typing import NDArray
from scipy.optimize import least_squares

import pumpmodel as pm

SPEED_RPM, DURATION_S, DT_S, NOISE_KPA = 100.0, 1.5, 2e-3, 0.3
NAMES = ("R (kPa s/mL)", "C (mL/kPa)", "L (kPa s²/mL)")


class Fit(NamedTuple):
    """R, C and L, their standard errors, and the true ones."""

    found: NDArray[np.float64]
    standard_error: NDArray[np.float64]
    true: NDArray[np.float64]


def outlet_kpa(pump: pm.Pump, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Outlet pressure of the pump on a line of these R, C and L."""
    resistance, compliance, inertance = values
    line = pm.Line(
        resistance_kpa_s_ml=resistance,
        compliance_ml_kpa=compliance,
        inertance_kpa_s2_ml=inertance,
        reservoir_kpa=pump.outlet.reservoir_kpa,
    )
    return pump.replace(outlet=line).simulate(speed_rpm=SPEED_RPM, duration_s=DURATION_S, dt_s=DT_S).p_out_kpa


def measure(pump: pm.Pump, seed: int) -> NDArray[np.float64]:
    """Return a waveform as a sensor would have given it."""
    exact = pump.simulate(speed_rpm=SPEED_RPM, duration_s=DURATION_S, dt_s=DT_S).p_out_kpa
    return exact + np.random.default_rng(seed).normal(0, NOISE_KPA, len(exact))


def fit(pump: pm.Pump, measured_kpa: NDArray[np.float64], guess: NDArray[np.float64]) -> Fit:
    """Least squares over the logarithms, so that the values stay positive.

    The standard errors follow from the Jacobian and the scatter of the residuals, taken as independent.
    """
    solution = least_squares(
        lambda logs: outlet_kpa(pump, np.exp(logs)) - measured_kpa, np.log(guess), x_scale="jac"
    )
    if not solution.success:
        message = f"the fit did not converge: {solution.message}"
        raise RuntimeError(message)
    found = np.exp(solution.x)
    variance = 2 * solution.cost / (len(measured_kpa) - len(found))
    covariance = variance * np.linalg.inv(solution.jac.T @ solution.jac)
    line = pump.outlet
    true = np.array([line.resistance_kpa_s_ml, line.compliance_ml_kpa, line.inertance_kpa_s2_ml])
    return Fit(found, found * np.sqrt(np.diag(covariance)), true)


def main(folder: Path) -> Fit:
    """Measure, fit and draw; return what was found."""
    folder.mkdir(parents=True, exist_ok=True)
    pump = pm.Pump.three_roller()
    measured_kpa = measure(pump, seed=7)
    guess = 2.0 * np.array([0.1108, 0.0361, 0.0042])
    result = fit(pump, measured_kpa, guess)
    time_s = DT_S * np.arange(len(measured_kpa))
    figure, (top, bottom) = plt.subplots(
        2, 1, figsize=(8, 5), sharex=True, layout="constrained", height_ratios=(3, 1)
    )
    top.plot(time_s, measured_kpa, ".", color="0.6", markersize=3, label="measured")
    top.plot(time_s, outlet_kpa(pump, guess), ":", color="#E69F00", linewidth=1.2, label="first guess")
    fitted = outlet_kpa(pump, result.found)
    top.plot(time_s, fitted, color="#0072B2", linewidth=1.2, label="fit")
    bottom.plot(time_s, measured_kpa - fitted, ".", color="0.6", markersize=3)
    top.set_ylabel("outlet pressure\n(kPa absolute)")
    top.set_title(
        ", ".join(
            f"{name} {value:.5f} ± {2 * error:.5f}"
            for name, value, error in zip(("R", "C", "L"), result.found, result.standard_error, strict=True)
        )
        + " (k = 2; kPa, s, mL)",
        fontsize="medium",
    )
    top.legend(loc="upper left", bbox_to_anchor=(1, 1), frameon=False)
    bottom.set(xlabel="time (s)", ylabel="residual\n(kPa)")
    for axis in (top, bottom):
        axis.grid(alpha=0.25)
        axis.margins(x=0)
    figure.savefig(folder / "fit_line.png", dpi=80)
    return result


if __name__ == "__main__":
    for name, *values in zip(NAMES, *main(Path(sys.argv[1])), strict=True):
        print("{}: {:.5f} +- {:.5f}, true {:.5f}".format(name, *values))
