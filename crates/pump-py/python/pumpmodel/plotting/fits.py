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
    from pumpmodel.identification.joint import JointlyIdentified
    from pumpmodel.volume_fit import VolumeFit, VolumePolynomial

# Name and label of what was varied, and label of what was measured.
_OVER = {
    "line": ("time_s", "time (s)", "pressure\n(kPa absolute)"),
    "resistance": ("flow_ml_s", "flow (mL/s)", "pressure drop\n(kPa)"),
    "compliance": ("volume_ml", "injected volume (mL)", "pressure\n(kPa)"),
}

# Number of measured points that would hide a curve.
_MANY = 60


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
        If matplotlib is missing, which `pip install './crates/pump-py[plot]'` brings.
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


def plot_jointly(found: JointlyIdentified, *, ax: Axes | Sequence[Axes] | None = None) -> list[Axes]:
    """Draw measurement and fit of each recording of a line, one below the other.

    Parameters
    ----------
    found : JointlyIdentified
        Result of `identify_line_jointly`.
    ax : Axes or sequence of Axes, optional
        Axes for each recording, or axes for the first alone. By default a new figure.

    Returns
    -------
    list of Axes
        Axes over the time, s, one for each recording.

    Raises
    ------
    ValueError
        If the number of axes is not that of the recordings.
    ImportError
        If matplotlib is missing, which `pip install './crates/pump-py[plot]'` brings.
    """
    axes = panels_for([f"recording {place}" for place in range(len(found.recordings))], ax)
    colour = BLUE if found.port == "inlet" else VERMILION
    for place, (axis, fit) in enumerate(zip(axes, found.recordings, strict=False)):
        size = 3 if len(fit.time_s) > 50 else 5
        axis.plot(
            *envelope(fit.time_s, fit.measured_kpa),
            ".",
            color=ink(axis, 0.45),
            markersize=size,
            label=f"measured, {place}",
        )
        axis.plot(
            *envelope(fit.time_s, fit.fitted_kpa), color=colour, linewidth=1.2, label=f"{found.port}, fitted"
        )
        axis.set_ylabel("pressure\n(kPa absolute)")
        finish(axis)
        axis.margins(x=0.02)
    if ax is None:
        told = [
            " ".join(parameter(name, value)) for name, value in found.parameters.items() if not value.held
        ]
        lines = [", ".join(told[at : at + 2]) for at in range(0, len(told), 2)]
        axes[0].set_title("\n".join(lines), fontsize="small")
    axes[-1].set_xlabel("time (s)")
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
        If matplotlib is missing, which `pip install './crates/pump-py[plot]'` brings.
    """
    (axis,) = panels_for(("volume",), ax)
    measured_deg, volume_ml = np.asarray(fit.angle_deg), np.asarray(fit.volume_ml)
    first = measured_deg.min()
    angle_deg = np.linspace(0, fit.engagement_deg, 400)
    is_many = len(measured_deg) > _MANY and not fit._is_function
    axis.plot(
        angle_deg,
        fit.displaced_ml(np.radians(angle_deg)),
        color=GREEN,
        linewidth=1.6 if is_many else 1.2,
        # Many points would hide the curve, which stands before them.
        zorder=3 if is_many else 2,
        label=f"{fit.method} fit",
    )
    if fit._is_function:
        # A function is a curve: it has every volume between its samples.
        axis.plot(
            measured_deg - first, volume_ml, "--", color=ink(axis, 0.7), linewidth=1.6, label="function"
        )
        measured_deg, volume_ml = measured_deg[:0], volume_ml[:0]
    runs = np.asarray(fit.run if fit.run is not None else [""] * len(measured_deg))
    markers = "osD^vP*Xh"
    for place, run in enumerate(dict.fromkeys(runs.tolist())):
        of_run = runs == run
        axis.plot(
            measured_deg[of_run] - first,
            volume_ml[of_run],
            markers[place % len(markers)],
            color=ink(axis, 0.3 if is_many else 0.55),
            markersize=2 if is_many else 4,
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


def plot_polynomial(volume: VolumePolynomial, *, ax: Axes | None = None) -> Axes:
    """Draw the volume of a roller by a polynomial over its angle.

    Parameters
    ----------
    volume : VolumePolynomial
        Volume by coefficients.
    ax : Axes, optional
        Axes to draw in. By default a new figure.

    Returns
    -------
    Axes
        Axes over the angle since the first contact, deg.

    Raises
    ------
    ImportError
        If matplotlib is missing, which `pip install './crates/pump-py[plot]'` brings.
    """
    (axis,) = panels_for(("volume",), ax)
    angle_deg = np.linspace(0, volume.engagement_deg, 400)
    for place, (from_deg, to_deg) in enumerate(volume.held_deg):
        label = None if place else "held, where\nit falls"
        axis.axvspan(from_deg, to_deg, color=ink(axis, 0.12), zorder=0, label=label)
    order = len(volume.coefficients_ml_deg) - 1
    axis.plot(
        angle_deg,
        volume.displaced_ml(np.radians(angle_deg)),
        color=GREEN,
        linewidth=1.2,
        label=f"polynomial of\norder {order}",
    )
    axis.set_xlabel("angle since the first contact (deg)")
    axis.set_ylabel("displaced volume (mL)")
    axis.set_title(f"{number(volume.total_ml)} mL over {number(volume.engagement_deg)}°", fontsize="medium")
    finish(axis)
    axis.margins(x=0.02)
    return axis
