"""Steady states over the speed: pressures with their range, flow and ripple."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from pumpmodel._pumpmodel import SteadyState
from pumpmodel.plotting.axes import BLUE, GREEN, VERMILION, finish, panels_for

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_PANELS = ("pressure", "flow", "ripple")


def plot_steady(steady: SteadyState[Any], *, ax: Axes | Sequence[Axes] | None = None) -> list[Axes]:
    """Draw steady states over the speed: mean and range of the pressures, mean flow, ripple.

    Parameters
    ----------
    steady : SteadyState
        Result of `Pump.steady_state` at one or more speeds.
    ax : Axes or sequence of Axes, optional
        Axes for pressures, flow and ripple, or axes for the pressures alone. By default a new figure.

    Returns
    -------
    list of Axes
        Axes of the panels.

    Raises
    ------
    ValueError
        If there is no speed, or the number of axes is neither 1 nor 3.
    ImportError
        If matplotlib is missing, which `pip install './crates/pump-py[plot]'` brings.
    """
    columns = {name: np.ravel(values) for name, values in steady.to_dict().items()}
    if not columns["speed_rpm"].size:
        message = "the steady state has no speeds; allowed: one speed at least"
        raise ValueError(message)
    order = np.argsort(columns["speed_rpm"])
    columns = {name: values[order] for name, values in columns.items()}
    rpm = columns["speed_rpm"]
    # A single speed is a point with its range; a line through it would not show.
    marker = "o" if len(rpm) == 1 else None
    axes = panels_for(_PANELS, ax)
    for name, axis in zip(_PANELS, axes, strict=False):
        if name == "pressure":
            for port, colour in (("inlet", BLUE), ("outlet", VERMILION)):
                least, most = columns[f"{port}_min_kpa"], columns[f"{port}_max_kpa"]
                if len(rpm) == 1:
                    axis.vlines(rpm, least, most, color=colour, linewidth=6, alpha=0.25)
                else:
                    axis.fill_between(rpm, least, most, color=colour, alpha=0.25, linewidth=0)
                mean = columns[f"{port}_mean_kpa"]
                axis.plot(
                    rpm, mean, color=colour, label=f"{port}, mean\nand range", linewidth=1.2, marker=marker
                )
            axis.set_ylabel("pressure\n(kPa absolute)")
        elif name == "flow":
            axis.plot(rpm, columns["mean_flow_ml_s"], color=GREEN, linewidth=1.2, marker=marker)
            axis.set_ylabel("mean flow\n(mL/s)")
        else:
            for column, label, line in (
                ("ripple_peak_to_peak", "peak to peak", "-"),
                ("ripple_rms", "root mean square", "--"),
            ):
                percent = 100 * columns[column]
                axis.plot(rpm, percent, line, color=VERMILION, linewidth=1.2, label=label, marker=marker)
            axis.set_ylim(bottom=0)
            axis.set_ylabel("ripple at the\noutlet rollers (%)")
        finish(axis, legend=name != "flow")
    axes[-1].set_xlabel("speed (r/min)")
    return axes
