"""Errors of a dose over all start angles: planned without the rollers' angle, and planned from it."""

# %%
import math
import sys
from pathlib import Path

import numpy as np
from matplotlib import pyplot as plt
from numpy.typing import NDArray

import pumpmodel as pm

VOLUMES_ML = (1, 5, 25)
COLOURS = ("#D55E00", "#E69F00", "#0072B2")


# %% [markdown]
# Two ways to dose: by one constant, and by a plan from the angle of the rollers.


# %%
def naive_error_percent(
    pump: pm.Pump, volume_ml: float, start_rad: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Turn volume / (volume per revolution) revolutions, from any angle of the rollers."""
    turn_rad = math.tau * volume_ml / pump.volume_per_revolution_ml
    dosed_ml = pump.outlet_volume_ml(start_rad + turn_rad) - pump.outlet_volume_ml(start_rad)
    return 100 * (dosed_ml / volume_ml - 1)


def planned_error_ul(pump: pm.Pump, volume_ml: float, start_rad: NDArray[np.float64]) -> NDArray[np.float64]:
    """Plan from the angle. The error is a fraction of a motor step, which is carried to the next dose."""
    doser = pm.Doser(pump)
    plans = [doser.plan(f"{volume_ml}mL", start_angle_rad=start) for start in start_rad]
    return 1000 * np.array([plan.planned_ml - volume_ml for plan in plans])


# %%
def main(folder: Path) -> dict[int, tuple[float, float]]:
    """Draw the figure; return the largest errors, in % without the angle and in uL with it, by volume."""
    folder.mkdir(parents=True, exist_ok=True)
    pump = pm.Pump.three_roller()
    figure, (naive, ours) = plt.subplots(2, 1, figsize=(8, 5.5), sharex=True, layout="constrained")
    largest = {}
    fine_rad, coarse_rad = np.linspace(0, math.tau / 3, 2000), np.linspace(0, math.tau / 3, 60)
    for volume_ml, colour in zip(VOLUMES_ML, COLOURS, strict=True):
        percent = naive_error_percent(pump, volume_ml, fine_rad)
        microlitres = planned_error_ul(pump, volume_ml, coarse_rad)
        naive.plot(np.degrees(fine_rad), percent, color=colour, label=f"{volume_ml} mL")
        ours.plot(np.degrees(coarse_rad), microlitres, ".", color=colour)
        largest[volume_ml] = (float(np.abs(percent).max()), float(np.abs(microlitres).max()))
    half_step = 500 * pump.outlet_flow_ml_rad(fine_rad).max() * math.tau / pump.steps_per_rev
    for limit in (-half_step, half_step):
        ours.axhline(limit, color="0.45", linestyle="--", linewidth=1)
    naive.set(ylabel="error (% of the dose)", title="volume / (volume per revolution) revolutions")
    naive.legend(loc="upper left", bbox_to_anchor=(1, 1), frameon=False)
    ours.set(xlabel="start angle (deg)", ylabel="error (µL)", title="planned from the rollers' angle")
    ours.set_ylim(-2 * half_step, 2 * half_step)
    ours.annotate(
        "half a motor step", (60, half_step), (0, 3), textcoords="offset points", ha="center", color="0.35"
    )
    for axis in (naive, ours):
        axis.grid(alpha=0.25)
        axis.margins(x=0)
    figure.savefig(folder / "dose_error.png", dpi=160)
    return largest


# %%
if __name__ == "__main__":
    for volume_ml, (percent, microlitres) in main(Path(sys.argv[1] if len(sys.argv) > 1 else ".")).items():
        print(f"{volume_ml} mL: {percent:.1f} % without the angle, {microlitres:.2f} uL with it")
