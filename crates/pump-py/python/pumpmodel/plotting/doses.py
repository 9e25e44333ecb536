"""The uncertainty of a dose by its sources, and the errors of weighed doses."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pumpmodel._pumpmodel import Plan
from pumpmodel._results.words import number
from pumpmodel.dose import Dose
from pumpmodel.plotting.axes import BLUE, GREEN, VERMILION, axes_for, finish, ink

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from pumpmodel.dose import Verification
    from pumpmodel.monte_carlo import VolumeTrials

# Below this standard uncertainty microlitres are easier to read, mL.
_SMALL_ML = 0.1


def plot_budget(dose: Dose | Plan, *, ax: Axes | None = None) -> Axes:
    """Draw the uncertainty budget of a dose: the standard uncertainty of each source, the largest on top.

    Parameters
    ----------
    dose : Dose or Plan
        Dose or plan with an `uncertainty_budget`.
    ax : Axes, optional
        Axes to draw in. By default a new figure.

    Returns
    -------
    Axes
        Axes with a bar for each source that contributes, and its share of the variance.

    Raises
    ------
    TypeError
        If `dose` is neither.
    ImportError
        If matplotlib is missing, which `pip install './crates/pump-py[plot]'` brings.
    """
    if not isinstance(dose, Dose | Plan):
        message = f"dose must be a Dose or a Plan, not {type(dose).__name__}"
        raise TypeError(message)
    if isinstance(dose, Plan):
        shares = [
            (share["source"], share["standard_ml"], share["variance_percent"])
            for share in dose.uncertainty_budget
        ]
    else:
        shares = [
            (share.source, share.standard_ml, share.variance_percent) for share in dose.uncertainty_budget
        ]
    # A source that contributes nothing would be an empty row.
    shares = sorted((share for share in shares if share[1] > 0), key=lambda share: share[1])
    (axis,) = axes_for(["budget"], ax)
    expanded_ml = dose.expanded_uncertainty_ml
    factor, unit = (1000, "µL") if expanded_ml < 2 * _SMALL_ML else (1, "mL")
    widths = [factor * standard for _, standard, _ in shares]
    bars = axis.barh([source.replace("_", " ") for source, _, _ in shares], widths, color=GREEN, height=0.6)
    labels = [f"{percent:.0f} %" if percent >= 1 else "< 1 %" for _, _, percent in shares]
    axis.bar_label(bars, labels, padding=4, fontsize="small")
    axis.set_xlim(0, 1.15 * max(widths, default=1.0))
    axis.set_xlabel(f"standard uncertainty ({unit}), and share of the variance")
    axis.set_title(
        f"{dose.requested_ml:.6g} mL ± {number(factor * expanded_ml, unit, 2)} (k = 2)", fontsize="medium"
    )
    axis.grid(axis="x", alpha=0.25)
    axis.set_axisbelow(True)
    return axis


def plot_verification(found: Verification, *, ax: Axes | None = None) -> Axes:
    """Draw weighed doses of one volume in their order, with the nominal volume and the errors allowed.

    Parameters
    ----------
    found : Verification
        Result of `Bench.verify`.
    ax : Axes, optional
        Axes to draw in. By default a new figure.

    Returns
    -------
    Axes
        Axes over the number of the dose.

    Raises
    ------
    ImportError
        If matplotlib is missing, which `pip install './crates/pump-py[plot]'` brings.
    """
    (axis,) = axes_for(["verification"], ax)
    order = np.arange(1, len(found.volumes_ml) + 1)
    allowed_ml = abs(found.nominal_ml) * found.tolerance.systematic_percent / 100
    axis.axhspan(
        found.nominal_ml - allowed_ml,
        found.nominal_ml + allowed_ml,
        color=ink(axis, 0.1),
        zorder=0,
        label="mean allowed",
    )
    axis.axhline(found.nominal_ml, color=ink(axis, 0.6), linewidth=1, linestyle="--", label="nominal")
    axis.axhspan(
        found.mean_ml - found.random_ml,
        found.mean_ml + found.random_ml,
        color=BLUE,
        alpha=0.2,
        linewidth=0,
        label="mean ± random error",
    )
    axis.axhline(found.mean_ml, color=BLUE, linewidth=1.2, label="mean")
    axis.plot(order, found.volumes_ml, "o", color=VERMILION, markersize=4, label="dose")
    axis.set_xlabel("dose")
    axis.set_ylabel("volume (mL)")
    axis.locator_params(axis="x", integer=True)
    axis.ticklabel_format(axis="y", useOffset=False)
    verdict = "passed" if found.passed else "not passed"
    axis.set_title(
        f"{verdict}: systematic {number(found.systematic_percent, '%', 2)} "
        f"(±{found.tolerance.systematic_percent:g} allowed), "
        f"random {number(found.random_percent, '%', 2)} ({found.tolerance.random_percent:g} allowed)",
        fontsize="small",
    )
    finish(axis)
    axis.margins(x=0.05)
    return axis


def plot_trials(drawn: VolumeTrials, *, ax: Axes | None = None) -> Axes:
    """Draw how often each volume occurs in the trials of a dose, beside the budget's expanded uncertainty.

    Parameters
    ----------
    drawn : VolumeTrials
        Result of `monte_carlo`.
    ax : Axes, optional
        Axes to draw in. By default a new figure.

    Returns
    -------
    Axes
        Axes over the volume.

    Raises
    ------
    ImportError
        If matplotlib is missing, which `pip install './crates/pump-py[plot]'` brings.
    """
    (axis,) = axes_for(["trials"], ax)
    axis.hist(drawn.volume_ml, bins="auto" if len(drawn.volume_ml) < 1000 else 80, density=True, color=GREEN)
    axis.axvspan(*drawn.interval_ml(), color=ink(axis, 0.12), zorder=0, label="95.45 % of the trials")
    for side in (-1, 1):
        axis.axvline(
            drawn.mean_ml + side * drawn.budget_expanded_ml,
            color=VERMILION,
            linewidth=1.2,
            linestyle="--",
            label="budget" if side > 0 else None,
        )
    axis.set_xlabel("volume (mL)")
    axis.set_ylabel("probability density (1/mL)")
    axis.ticklabel_format(axis="x", useOffset=False)
    axis.set_title(f"{len(drawn.volume_ml)} trials of a dose", fontsize="medium")
    finish(axis)
    return axis
