"""The flow over one pitch of a pump, and the error of a dose that does not know the rollers' angle."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from pumpmodel._pumpmodel import Pump, _numbers
from pumpmodel.plotting.axes import BLUE, GREEN, ORANGE, VERMILION, WIDE, axes_for, finish, ink

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

_ANGLES = 2001
_COLOURS = (VERMILION, ORANGE, BLUE, GREEN)


def plot_pitch(pump: Pump, *, ax: Axes | None = None) -> Axes:
    """Draw the flow per radian at inlet and outlet over one pitch.

    Parameters
    ----------
    pump : Pump
        Pump to draw.
    ax : Axes, optional
        Axes to draw in. By default a new figure.

    Returns
    -------
    Axes
        Axes over the rollers' angle, deg; at 0 a roller begins to leave the outlet.

    Raises
    ------
    ImportError
        If matplotlib is missing, which `pip install './crates/pump-py[plot]'` brings.
    """
    _check(pump)
    (axis,) = axes_for(["pitch"], ax)
    angle_rad = np.linspace(0, pump.pitch_rad, _ANGLES)
    for name, colour, width, flow in (
        ("inlet", BLUE, WIDE, pump.inlet_flow_ml_rad(angle_rad)),
        ("outlet", VERMILION, 1.2, pump.outlet_flow_ml_rad(angle_rad)),
    ):
        axis.plot(np.degrees(angle_rad), flow, color=colour, linewidth=width, label=name)
    mean = pump.volume_per_revolution_ml / math.tau
    axis.axhline(mean, color=ink(axis, 0.55), linewidth=1, linestyle="--", label="mean")
    axis.set_ylim(bottom=min(0.0, axis.get_ylim()[0]))
    if axis.get_ylim()[0] < 0:
        axis.axhline(0, color=ink(axis, 0.55), linewidth=1)
    axis.set_xlabel("angle of the rollers (deg)")
    axis.set_ylabel("flow at the rollers (mL/rad)")
    axis.set_title(f"{pump.name}: one pitch", fontsize="medium")
    finish(axis)
    return axis


def dose_errors(pump: Pump, volume_ml: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return start angles over one pitch (deg), and the error of a dose by one constant from each (%)."""
    start_rad = np.linspace(0, pump.pitch_rad, _ANGLES)
    turn_rad = math.tau * volume_ml / pump.volume_per_revolution_ml
    dosed_ml = pump.outlet_volume_ml(start_rad + turn_rad) - pump.outlet_volume_ml(start_rad)
    return np.degrees(start_rad), 100 * (dosed_ml / volume_ml - 1)


def plot_dose_error(
    pump: Pump, volume_ml: float | Sequence[float] = (1.0, 5.0, 25.0), *, ax: Axes | None = None
) -> Axes:
    """Draw the error over the start angle of a dose for which one constant gives the turn.

    Such a dose turns volume / (volume per revolution) revolutions, wherever the rollers stand. A plan of
    `Doser` from the angle has less than a motor step of error.

    Parameters
    ----------
    pump : Pump
        Pump that doses.
    volume_ml : float or sequence of float
        Volumes of the doses, mL, not zero; negative in reverse.
    ax : Axes, optional
        Axes to draw in. By default a new figure.

    Returns
    -------
    Axes
        Axes with a curve for each volume over the start angle, deg, in per cent of the dose.

    Raises
    ------
    ValueError
        If a volume is zero or not finite.
    ImportError
        If matplotlib is missing, which `pip install './crates/pump-py[plot]'` brings.
    """
    _check(pump)
    volumes = np.atleast_1d(np.asarray(_numbers("volume_ml", volume_ml), dtype=np.float64)).ravel()
    if not len(volumes):
        message = "volume_ml is empty; allowed: one volume at least"
        raise ValueError(message)
    for volume in volumes:
        if not math.isfinite(volume) or volume == 0:
            message = f"volume_ml is {volume:g}; allowed: a finite volume, not 0"
            raise ValueError(message)
    (axis,) = axes_for(["error"], ax)
    lines = ("-", "--", "-.", ":")
    for number, volume in enumerate(volumes):
        line, colour = lines[number // len(_COLOURS) % len(lines)], _COLOURS[number % len(_COLOURS)]
        axis.plot(
            *dose_errors(pump, float(volume)), line, color=colour, linewidth=1.2, label=f"{volume:.6g} mL"
        )
    axis.axhline(0, color=ink(axis, 0.55), linewidth=1)
    axis.set_xlabel("start angle (deg)")
    axis.set_ylabel("error (% of the dose)")
    axis.set_title("volume / (volume per revolution) revolutions", fontsize="medium")
    finish(axis)
    return axis


def _check(pump: object) -> None:
    if not isinstance(pump, Pump):
        message = f"pump must be a Pump, not {type(pump).__name__}"
        raise TypeError(message)
