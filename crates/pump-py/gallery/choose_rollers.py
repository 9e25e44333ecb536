"""Choose the number of rollers and the contact angle for an outlet pressure that swings at most by a target.

Each roller takes its volume from the outlet, so more rollers make the flow at the rollers less even. Their
pulses also follow each other faster, and a line passes on less of them beyond its resonance. The contact
angle changes neither: it decides how many rollers seal at every angle. All heads follow from their drawings
and have the lines of McIntyre et al.
"""

# %%
import math
import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np
from matplotlib import pyplot as plt
from numpy.typing import NDArray

import pumpmodel as pm

FLOW_ML_S, TARGET_KPA, SEALING = 45.0, 25.0, 2
ROLLERS = np.arange(2, 9)
ANGLES_DEG = np.arange(0.0, 61.0, 5.0)


# %% [markdown]
# The heads differ in the number of rollers and in the contact angle alone.


# %%
class Choice(NamedTuple):
    """The chosen head, the swing by rollers, and the sealing rollers by rollers and contact angle."""

    head: pm.Pump
    swing_kpa: NDArray[np.float64]
    sealing: NDArray[np.int64]


def head(rollers: int, contact_angle_deg: float) -> pm.Pump:
    """Return a head of this design; the rest of its drawing and its lines stay the same."""
    drawn = pm.Pump.from_drawing(
        f"head-{rollers}",
        rollers=rollers,
        bore_radius_mm=5,
        tube_outer_radius_mm=7,
        backplate_radius_mm=63,
        contact_angle_deg=contact_angle_deg,
        roller_radius_mm=15,
        roller_offset_mm=45,
        hose_length_mm=331,
    )
    line = pm.Pump.three_roller().outlet
    return drawn.replace(inlet=line, outlet=line)


def sealing_rollers(rollers: int, contact_angle_deg: float) -> int:
    """Return the number of rollers fully engaged at every angle. The model refuses a head with none."""
    try:
        pump = head(rollers, contact_angle_deg)
    except ValueError:
        return 0
    sealed_rad = math.tau - pump.engagement_rad - pump.inlet_phase_rad
    return int(sealed_rad / pump.pitch_rad)


# %% [markdown]
# The choice is the fewest rollers that keep to the target, at the smallest angle at which enough seal.


# %%
def main(folder: Path) -> Choice:
    """Choose, draw, and return the choice."""
    folder.mkdir(parents=True, exist_ok=True)
    sealing = np.array([[sealing_rollers(int(count), angle) for angle in ANGLES_DEG] for count in ROLLERS])
    # The contact angle does not change the outlet's flow: any angle that works will do here.
    heads = [head(int(count), ANGLES_DEG[row > 0][0]) for count, row in zip(ROLLERS, sealing, strict=True)]
    speed_rpm = np.array([pump.speed_for_flow_rpm(flow_ml_s=FLOW_ML_S) for pump in heads])
    steady = [pump.steady_state(speed_rpm=speed) for pump, speed in zip(heads, speed_rpm, strict=True)]
    swing_kpa = np.array([state.outlet_max_kpa - state.outlet_min_kpa for state in steady])
    fits = np.flatnonzero((swing_kpa <= TARGET_KPA) & (sealing.max(axis=1) >= SEALING))
    if not fits.size:
        message = f"no head keeps to {TARGET_KPA} kPa; the least is {swing_kpa.min():.1f} kPa"
        raise ValueError(message)
    row = fits[0]
    angle = ANGLES_DEG[sealing[row] >= SEALING][0]
    chosen = head(int(ROLLERS[row]), angle)

    figure, axes = plt.subplots(2, 2, figsize=(11, 8), layout="constrained")
    (by_rollers, angles), (whole_map, section) = axes
    by_rollers.bar(ROLLERS, swing_kpa, color=np.where(ROLLERS[row] == ROLLERS, "#0072B2", "#c0c0c0"))
    by_rollers.axhline(TARGET_KPA, color="#D55E00", linestyle="--", label=f"target, {TARGET_KPA:g} kPa")
    by_rollers.set(xlabel="rollers", ylabel="outlet pressure, peak to peak (kPa)")
    by_rollers.set_title(f"swing at {FLOW_ML_S:g} mL/s on average", fontsize="medium")
    ripple = by_rollers.twinx()
    ripple.plot(ROLLERS, [100 * state.ripple_rms for state in steady], "o-", color="0.3", label="flow ripple")
    ripple.set(ylabel="flow ripple at the rollers, RMS (%)", ylim=(0, 80))
    handles = [drawn.get_legend_handles_labels() for drawn in (by_rollers, ripple)]
    by_rollers.legend(handles[0][0] + handles[1][0], handles[0][1] + handles[1][1], loc="upper right")
    by_rollers.set_ylim(0, 1.3 * swing_kpa.max())

    angles.pcolormesh(ANGLES_DEG, ROLLERS, sealing, cmap="Blues", vmin=-1, vmax=7, edgecolor="white")
    for count, found in zip(ROLLERS, sealing, strict=True):
        for place, number in zip(ANGLES_DEG, found, strict=True):
            angles.text(place, count, str(number), ha="center", va="center", fontsize="small")
    angles.plot(angle, ROLLERS[row], "s", markersize=17, markerfacecolor="none", markeredgecolor="#D55E00")
    angles.set(xlabel="contact angle β (deg)", ylabel="rollers")
    angles.set_title("rollers that seal at every angle (0: refused)", fontsize="medium")

    sweep = pm.sweep(heads, speed_rpm=np.linspace(20, 220, 200))
    pm.plot_map(
        sweep,
        sweep.outlet_max_kpa - sweep.outlet_min_kpa,
        label="outlet pressure, peak to peak (kPa)",
        ax=whole_map,
    )
    whole_map.plot(speed_rpm, ROLLERS, "o", color="white", markersize=4)
    whole_map.set_title(f"all speeds; dots: {FLOW_ML_S:g} mL/s", fontsize="medium")
    pm.plot_pump(chosen, ax=section)
    section.set_title(f"the choice: {chosen.rollers} rollers, β {angle:g}°", fontsize="medium")
    figure.savefig(folder / "choose_rollers.png", dpi=160)
    return Choice(chosen, swing_kpa, sealing)


# %%
if __name__ == "__main__":
    choice = main(Path(sys.argv[1] if len(sys.argv) > 1 else "."))
    for rollers, swing in zip(ROLLERS, choice.swing_kpa, strict=True):
        print(f"{rollers} rollers: {swing:.1f} kPa peak to peak at {FLOW_ML_S:g} mL/s")
    print(f"chosen: {choice.head!r}, contact angle {math.degrees(choice.head.contact_angle_rad):.0f} deg")
