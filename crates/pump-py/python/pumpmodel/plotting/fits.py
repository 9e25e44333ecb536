"""Fits with their measurements: an identified line, and the volume of a roller."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from pumpmodel._results.words import number, parameter
from pumpmodel.plotting.axes import BLUE, GREEN, VERMILION, finish, ink, panels_for
from pumpmodel.plotting.envelope import envelope

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from pumpmodel.identification.identified import Identified
    from pumpmodel.volume_fit import VolumeFit

# Name and label of what was varied, and label of what was measured.
_OVER = {
    "line": ("time_s", "time (s)", "pressure\n(kPa absolute)"),
    "resistance": ("flow_ml_s", "flow (mL/s)", "pressure drop\n(kPa)"),
    "compliance": ("volume_ml", "injected volume (mL)", "pressure\n(kPa)"),
}


def plot_identified(found: Identified, *, ax: Axes | Sequence[Axes] | None = None) -> list[Axes]:
    """Draw measurement and fit of an identified line, and the residuals below them.

    Parameters
    ----------
    found : Identified
        Result of `identify_line`, `identify_resistance` or `identify_compliance`.
    ax : Axes or sequence of Axes, optional
        Axes for the fit and for the residuals, or axes for the fit alone. By default a new figure.

    Returns
    -------
    list of Axes
        Axes of the fit and of the residuals.

    Raises
    ------
    ValueError
        If the number of axes is neither 1 nor 2.
    ImportError
        If matplotlib is missing, which `pip install 'pumpmodel[plot]'` brings.
    """
    name, x_label, y_label = _OVER[found.kind]
    x = getattr(found, name)
    axes = panels_for(("fit", "residual"), ax)
    # Dots would hide the curve of a long record, and the curve the dots of a short one.
    size = 3 if len(x) > 50 else 5
    colour = BLUE if found.port == "inlet" else VERMILION
    top = axes[0]
    top.plot(*envelope(x, found.measured_kpa), ".", color=ink(top, 0.45), markersize=size, label="measured")
    top.plot(*envelope(x, found.fitted_kpa), color=colour, linewidth=1.2, label=f"{found.port}, fitted")
    top.set_ylabel(y_label)
    told = [
        " ".join(parameter(label, estimate))
        for label, estimate in found.parameters.items()
        if not estimate.held
    ]
    if ax is None:
        lines = [", ".join(told[at : at + 2]) for at in range(0, len(told), 2)]
        top.set_title("\n".join(lines), fontsize="small")
    finish(top)
    if len(axes) > 1:
        below = axes[1]
        below.plot(*envelope(x, found.residual_kpa), ".", color=ink(below, 0.45), markersize=size)
        below.axhline(0, color=colour, linewidth=1)
        below.set_ylabel("residual\n(kPa)")
        finish(below, legend=False)
    for axis in axes:
        axis.margins(x=0.02)
    axes[-1].set_xlabel(x_label)
    return axes


def plot_volume(fit: VolumeFit, *, ax: Axes | None = None) -> Axes:
    """Draw the volume of a roller over its angle: measured points, and the fitted curve.

    Parameters
    ----------
    fit : VolumeFit
        Fitted volume.
    ax : Axes, optional
        Axes to draw in. By default a new figure.

    Returns
    -------
    Axes
        Axes over the angle since the first contact, deg.

    Raises
    ------
    ImportError
        If matplotlib is missing, which `pip install 'pumpmodel[plot]'` brings.
    """
    (axis,) = panels_for(("volume",), ax)
    measured_deg, volume_ml = np.asarray(fit.angle_deg), np.asarray(fit.volume_ml)
    first = measured_deg.min()
    angle_deg = np.linspace(0, fit.engagement_deg, 400)
    axis.plot(
        angle_deg,
        fit.displaced_ml(np.radians(angle_deg)),
        color=GREEN,
        linewidth=1.2,
        label=f"{fit.method} fit",
    )
    runs = np.asarray(fit.run if fit.run is not None else [""] * len(measured_deg))
    markers = "osD^vP*Xh"
    for place, run in enumerate(dict.fromkeys(runs.tolist())):
        of_run = runs == run
        axis.plot(
            measured_deg[of_run] - first,
            volume_ml[of_run],
            markers[place % len(markers)],
            color=ink(axis, 0.55),
            markersize=4,
            label=f"run {run}" if run else "measured",
        )
    axis.set_xlabel("angle since the first contact (deg)")
    axis.set_ylabel("displaced volume (mL)")
    axis.set_title(
        f"{number(fit.total_ml)} mL over {number(fit.engagement_deg)}°, "
        f"residuals {number(1000 * fit.rms_ml, digits=2)} µL RMS",
        fontsize="medium",
    )
    finish(axis)
    axis.margins(x=0.02)
    return axis
