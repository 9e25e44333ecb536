"""Pictures of runs and plans over time."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple, overload

from pumpmodel._pumpmodel import Plan, Run
from pumpmodel._results import checks
from pumpmodel.choices import Panel
from pumpmodel.plotting.axes import BLUE, VERMILION, WIDE, axes_for, finish, ink
from pumpmodel.plotting.envelope import envelope

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Number of samples of a plan, from which its envelope is drawn: a tenth of them misses extremes of an hour.
_SAMPLES = 1_000_000
_RPM_PER_RAD_S = 60 / math.tau


class _Curve(NamedTuple):
    label: str
    column: str
    colour: str
    factor: float = 1.0
    width: float = 1.2


_PANELS: dict[str, tuple[str, tuple[_Curve, ...]]] = {
    "flow": (
        "flow at the rollers\n(mL/s)",
        (
            _Curve("inlet", "inlet_flow_ml_s", BLUE, width=WIDE),
            _Curve("outlet", "outlet_flow_ml_s", VERMILION),
        ),
    ),
    "pressure": (
        "pressure\n(kPa absolute)",
        (_Curve("inlet", "inlet_kpa", BLUE, width=WIDE), _Curve("outlet", "outlet_kpa", VERMILION)),
    ),
    "speed": ("speed\n(r/min)", (_Curve("pump head", "speed_rad_s", BLUE, _RPM_PER_RAD_S),)),
    "delivered": ("delivered\n(mL)", (_Curve("vessel", "delivered_ml", VERMILION),)),
}


@overload
def plot(result: Run | Plan, *, panels: Panel, ax: Axes | None = None) -> Axes: ...
@overload
def plot(
    result: Run | Plan,
    *,
    panels: list[Panel] | tuple[Panel, ...] | None = None,
    ax: Sequence[Axes] | None = None,
) -> list[Axes]: ...
def plot(
    result: Run | Plan,
    *,
    panels: Panel | list[Panel] | tuple[Panel, ...] | None = None,
    ax: Axes | Sequence[Axes] | None = None,
) -> Axes | list[Axes]:
    """Draw a run or a plan over time.

    A run of more than 20,000 samples is drawn as its envelope, which keeps the extremes of each column of
    pixels.

    Parameters
    ----------
    result : Run or Plan
        Run, or plan: a plan shows its predicted trace, with marks at the last step of the dose
        and the requested volume. The time in which a retraction sucks back is shaded.
    panels : {"flow", "pressure", "speed", "delivered"} or sequence of these, optional
        Panels from top to bottom. By default a plan has all of them, and a run all but the speed.
    ax : Axes or sequence of Axes, optional
        Axes to draw in, one for each panel. By default a new figure.

    Returns
    -------
    Axes or list of Axes
        Axes of the panel if `panels` is one name, otherwise a list of the axes of all panels.

    Raises
    ------
    ValueError
        If no panel has this name, or the numbers of panels and axes differ.
    ImportError
        If matplotlib is missing, which `pip install './crates/pump-py[plot]'` brings.
    """
    if not isinstance(result, Run | Plan):
        message = f"a Run or a Plan can be plotted, not {type(result).__name__}"
        raise TypeError(message)
    if isinstance(panels, str):
        names: list[str] = [panels]
    elif panels is None:
        names = ["flow", "pressure", "delivered"]
        names[2:2] = ["speed"] if isinstance(result, Plan) else []
    else:
        names = checks.items("panels", panels, str, plural="names")
    if not names:
        message = f"panels is empty; allowed: one name at least of {', '.join(_PANELS)}"
        raise ValueError(message)
    for name in names:
        checks.chosen("panels", name, _PANELS)
    axes = axes_for(names, ax)
    run = result if isinstance(result, Run) else result.trace(dt_s=max(1e-3, result.settled_s / _SAMPLES))
    for name, axis in zip(names, axes, strict=True):
        label, curves = _PANELS[name]
        for curve in curves:
            time_s, values = envelope(run.time_s, getattr(run, curve.column))
            # Envelopes of both ports may cover one another.
            alpha = 0.6 if len(time_s) < len(run) else 1.0
            axis.plot(
                time_s,
                values * curve.factor,
                color=curve.colour,
                linewidth=curve.width,
                alpha=alpha,
                label=curve.label,
            )
        axis.set_ylabel(label)
        if isinstance(result, Plan):
            axis.axvline(
                result.motion_s, color=ink(axis, 0.55), linewidth=1, linestyle=":", label="last step"
            )
            if name == "delivered":
                asked = result.requested_ml + result.carry_in_ml
                axis.axhline(asked, color=ink(axis, 0.55), linewidth=1, linestyle="--", label="asked for")
            if result.retract_steps:
                back_s = float(result.step_times_s[abs(result.steps)])
                axis.axvspan(
                    back_s,
                    float(result.step_times_s[-1]),
                    color=ink(axis, 0.1),
                    zorder=0,
                    label="sucked back",
                )
        finish(axis, legend=len(curves) > 1 or (name == "delivered" and isinstance(result, Plan)))
    if axes:
        axes[-1].set_xlabel("time (s)")
    if axes and ax is None and isinstance(result, Plan):
        axes[0].set_title(
            f"{result.pump.name}: {result.planned_ml:.2f} mL at {result.cruise_flow_ml_s:.3g} mL/s",
            fontsize="medium",
        )
    return axes[0] if isinstance(panels, str) else axes
