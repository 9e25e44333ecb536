"""Knowledge of a line: the derivatives of a run, and the fit that an experiment would give."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from pumpmodel._results.sensitivity import PARAMETERS, Sensitivity
from pumpmodel._results.words import number
from pumpmodel.plotting.axes import BLUE, GREEN, VERMILION, axes_for, finish, panels_for
from pumpmodel.plotting.envelope import envelope

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from pumpmodel.identification.experiment import ExpectedFit

# Symbols of the parameters, in the order of the rows of a sensitivity.
SYMBOLS = ("R", "C", "L", "start angle", "roller volume")


def plot_sensitivity(found: Sensitivity, *, ax: Axes | Sequence[Axes] | None = None) -> list[Axes]:
    """Draw the derivatives of both pressures over time, one panel for each parameter.

    Parameters
    ----------
    found : Sensitivity
        Derivatives of a run.
    ax : Axes or sequence of Axes, optional
        Axes for each of the five parameters, or axes for the first alone. By default a new figure.

    Returns
    -------
    list of Axes
        Axes over the time, s.

    Raises
    ------
    ValueError
        If the number of axes is neither 1 nor 5.
    ImportError
        If matplotlib is missing, which `pip install './crates/pump-py[plot]'` brings.
    """
    axes = panels_for(tuple(PARAMETERS), ax)
    units = [unit for unit, _ in PARAMETERS.values()]
    for row, axis in enumerate(axes):
        for name, colour, rows in (
            ("inlet", BLUE, found.inlet_kpa_by),
            ("outlet", VERMILION, found.outlet_kpa_by),
        ):
            axis.plot(*envelope(found.time_s, rows[row]), color=colour, linewidth=1.2, label=name)
        axis.set_ylabel(f"by {SYMBOLS[row]}\n(kPa over\n{units[row]})")
        finish(axis, legend=row == 0)
    axes[-1].set_xlabel("time (s)")
    return axes


def plot_expected(fit: ExpectedFit, *, ax: Axes | None = None) -> Axes:
    """Draw the standard uncertainties of R, C and L that a fit is expected to have.

    Parameters
    ----------
    fit : ExpectedFit
        Fit that `next_experiment` expects.
    ax : Axes, optional
        Axes to draw in. By default a new figure.

    Returns
    -------
    Axes
        Axes with a bar for each parameter, % of its value.

    Raises
    ------
    ImportError
        If matplotlib is missing, which `pip install './crates/pump-py[plot]'` brings.
    """
    (axis,) = axes_for(["expected"], ax)
    bars = axis.barh(SYMBOLS[2::-1], fit.relative_percent[::-1], color=GREEN, height=0.6)
    labels = [number(percent, "%", 2) for percent in fit.relative_percent[::-1]]
    axis.bar_label(bars, labels, padding=4, fontsize="small")
    axis.set_xlim(0, 1.15 * max(fit.relative_percent) or 1.0)
    axis.set_xlabel("expected standard uncertainty (% of the value)")
    made = fit.experiment
    axis.set_title(
        f"{made.speed_rpm:g} r/min for {made.duration_s:g} s: {number(fit.gain_nats)} nats", fontsize="medium"
    )
    axis.grid(axis="x", alpha=0.25)
    axis.set_axisbelow(True)
    return axis
