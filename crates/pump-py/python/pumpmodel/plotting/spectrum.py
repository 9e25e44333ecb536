"""The spectrum of a pulsation."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from pumpmodel.plotting.axes import GREEN, axes_for, finish

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from pumpmodel._results.harmonics import Harmonics

_PANELS = ("flow", "pressure")


def plot_spectrum(found: Harmonics, *, ax: Axes | Sequence[Axes] | None = None) -> list[Axes]:
    """Draw the amplitudes of a pulsation's harmonics over their frequencies.

    Parameters
    ----------
    found : Harmonics
        Result of `Pump.harmonics`.
    ax : sequence of Axes, optional
        Axes for flow and pressure. By default a new figure.

    Returns
    -------
    list of Axes
        Axes of the flow at the rollers and of the pressure.

    Raises
    ------
    ValueError
        If the number of axes is not 2.
    ImportError
        If matplotlib is missing, which `pip install './crates/pump-py[plot]'` brings.
    """
    axes = axes_for(_PANELS, ax)
    hertz = np.asarray(found.rad_s) / math.tau
    for axis, amplitudes, label in zip(
        axes,
        (found.flow_ml_s, found.pressure_kpa),
        ("flow at the rollers,\namplitude (mL/s)", "pressure,\namplitude (kPa)"),
        strict=True,
    ):
        axis.vlines(hertz, 0, np.abs(amplitudes), color=GREEN, linewidth=2)
        axis.plot(hertz, np.abs(amplitudes), "o", color=GREEN, markersize=4)
        axis.set_ylabel(label)
        finish(axis, legend=False)
        axis.set_xlim(0, 1.05 * hertz.max() if hertz.size else 1)
        axis.set_ylim(bottom=0)
    axes[-1].set_xlabel("frequency (Hz)")
    return axes
