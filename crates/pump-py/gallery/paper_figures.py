"""The figures of McIntyre et al. by the model: the volume that rollers take from the flow, and the pressures.

The paper's raw curves were not published; this is our model of its pump, not a copy of its plots.
"""

# %%
import math
import sys
from pathlib import Path

import numpy as np
from matplotlib import pyplot as plt

import pumpmodel as pm

PUMPS = (pm.Pump.three_roller(), pm.Pump.two_roller())
BLUE, VERMILION = "#0072B2", "#D55E00"


# %% [markdown]
# Both figures are of both pumps: with three rollers and with two.


# %%
def main(folder: Path) -> list[tuple[float, float]]:
    """Draw both figures; return peak (mL/s) and duration (s) of each pump's pulse at 60 r/min."""
    folder.mkdir(parents=True, exist_ok=True)
    pulses = draw_flow(folder / "roller_flow.png")
    draw_pressures(folder / "pressures.png")
    return pulses


def draw_flow(file: Path) -> list[tuple[float, float]]:
    """Draw the flow that the rollers take at 60 r/min: a omega less the flow."""
    figure, axes = plt.subplots(1, 2, figsize=(9.5, 3), sharey=True, layout="constrained")
    pulses = []
    time_s = np.linspace(0, 1, 4001)
    for axis, pump in zip(axes, PUMPS, strict=True):
        angle_rad = math.tau * time_s
        whole = pump.outlet_flow_ml_rad(pump.engagement_rad)
        for name, colour, flow in (
            ("inlet", BLUE, pump.inlet_flow_ml_rad(angle_rad)),
            ("outlet", VERMILION, pump.outlet_flow_ml_rad(angle_rad)),
        ):
            taken = (whole - flow) * math.tau
            axis.plot(time_s, taken, color=colour, label=name)
        axis.set(xlabel="time (s)", title=f"{pump.rollers} rollers, 60 r/min")
        axis.grid(alpha=0.25)
        axis.margins(x=0)
        pulses.append((float(taken.max()), pump.engagement_rad / math.tau))
    axes[0].set_ylabel("flow taken by a roller\n(mL/s)")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside right upper", frameon=False)
    figure.savefig(file, dpi=160)
    return pulses


def draw_pressures(file: Path) -> None:
    """Draw the pressures over one second at three speeds, in the steady state."""
    figure, axes = plt.subplots(3, 2, figsize=(9.5, 6.5), sharex=True, sharey="row", layout="constrained")
    for column, pump in enumerate(PUMPS):
        for axis, speed_rpm in zip(axes[:, column], (50, 100, 150), strict=True):
            run = pump.simulate(speed_rpm=speed_rpm, duration_s=6)
            shown = run.time_s >= 5
            axis.plot(run.time_s[shown] - 5, run.inlet_kpa[shown], color=BLUE, label="inlet")
            axis.plot(run.time_s[shown] - 5, run.outlet_kpa[shown], color=VERMILION, label="outlet")
            axis.set_title(f"{pump.rollers} rollers, {speed_rpm} r/min", fontsize="medium")
            axis.grid(alpha=0.25)
            axis.margins(x=0)
    for axis in axes[:, 0]:
        axis.set_ylabel("pressure\n(kPa absolute)")
    for axis in axes[-1]:
        axis.set_xlabel("time (s)")
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside right upper", frameon=False)
    figure.savefig(file, dpi=160)


# %%
if __name__ == "__main__":
    for pump, (peak, duration) in zip(
        PUMPS, main(Path(sys.argv[1] if len(sys.argv) > 1 else ".")), strict=True
    ):
        print(f"{pump.rollers} rollers: a pulse of {peak:.3f} mL/s at most, {duration:.5f} s long")
