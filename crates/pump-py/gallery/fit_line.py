"""Resistance, compliance and inertance of an outlet line from a measured pressure waveform.

The measurement is simulated: the model at 100 r/min from rest, read every 2 ms, with white noise of 0.3 kPa.
The fit starts a factor of two away. Replace `measure` to fit a waveform of your own.
"""

# %%
import sys
from pathlib import Path

import numpy as np
from matplotlib import pyplot as plt
from numpy.typing import NDArray

import pumpmodel as pm

SPEED_RPM, DURATION_S, DT_S, NOISE_KPA = 100.0, 1.5, 2e-3, 0.3
NAMES = ("resistance_kpa_s_ml", "compliance_ml_kpa", "inertance_kpa_s2_ml")


# %% [markdown]
# A measurement, and the fit to it. `scaled` makes a first guess that is wrong by a factor.


# %%
def outlet(pump: pm.Pump) -> pm.Run:
    """Run the pump from rest at once."""
    return pump.simulate(speed_rpm=SPEED_RPM, duration_s=DURATION_S, dt_s=DT_S)


def measure(pump: pm.Pump, seed: int) -> NDArray[np.float64]:
    """Return a waveform as a sensor would have given it."""
    exact = outlet(pump).outlet_kpa
    return exact + np.random.default_rng(seed).normal(0, NOISE_KPA, len(exact))


def fit(guess: pm.Pump, measured_kpa: NDArray[np.float64]) -> pm.Identified:
    """Find the line, starting from the line of a guess."""
    time_s = DT_S * np.arange(len(measured_kpa))
    return pm.identify_line(
        guess,
        time_s=time_s,
        pressure_kpa=measured_kpa,
        speed_rpm=SPEED_RPM,
        begin="step",
        start_angle_rad=0.0,
    )


def scaled(pump: pm.Pump, factor: float) -> pm.Pump:
    """Return the pump on a line of `factor` times its R, C and L."""
    values = {name: factor * getattr(pump.outlet, name) for name in NAMES}
    return pump.replace(outlet=pump.outlet.replace(**values))


# %%
def main(folder: Path) -> pm.Identified:
    """Measure, fit and draw; return the identified line."""
    folder.mkdir(parents=True, exist_ok=True)
    pump = pm.Pump.three_roller()
    guess = scaled(pump, 2.0)
    found = fit(guess, measure(pump, seed=7))
    figure, (top, bottom) = plt.subplots(
        2, 1, figsize=(8, 5), sharex=True, layout="constrained", height_ratios=(3, 1)
    )
    top.plot(found.time_s, found.measured_kpa, ".", color="0.6", markersize=3, label="measured")
    top.plot(found.time_s, outlet(guess).outlet_kpa, ":", color="#E69F00", linewidth=1.2, label="first guess")
    top.plot(found.time_s, found.fitted_kpa, color="#0072B2", linewidth=1.2, label="fit")
    bottom.plot(found.time_s, found.residual_kpa, ".", color="0.6", markersize=3)
    top.set_ylabel("outlet pressure\n(kPa absolute)")
    estimates = [found.parameters[name] for name in NAMES]
    top.set_title(
        ", ".join(
            f"{letter} {estimate.value:.5f} ± {2 * estimate.standard:.5f}"
            for letter, estimate in zip("RCL", estimates, strict=True)
        )
        + " (k = 2; kPa, s, mL)",
        fontsize="medium",
    )
    top.legend(loc="upper left", bbox_to_anchor=(1, 1), frameon=False)
    bottom.set(xlabel="time (s)", ylabel="residual\n(kPa)")
    for axis in (top, bottom):
        axis.grid(alpha=0.25)
        axis.margins(x=0)
    figure.savefig(folder / "fit_line.png", dpi=160)
    return found


# %%
if __name__ == "__main__":
    print(main(Path(sys.argv[1] if len(sys.argv) > 1 else ".")))
