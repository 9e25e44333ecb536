"""Pictures of runs, plans and sweeps, by matplotlib (`pip install 'pumpmodel[plot]'`)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, TypeAlias, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pumpmodel._pumpmodel import Plan, Run, SteadyState
from pumpmodel._tables import COLUMNS, optional
from pumpmodel.sweeps import RESULTS, Sweep

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    _Panel: TypeAlias = Literal["flow", "pressure", "speed", "delivered"]

# Colours that stay apart for colour-blind readers (Okabe and Ito, 2008); as in `dose --plot`.
BLUE = "#0072B2"
VERMILION = "#D55E00"

# Samples of a plan: far more than a picture has pixels, far fewer than hours of milliseconds.
_SAMPLES = 100_000
_RPM_PER_RAD_S = 60 / math.tau


class _Curve(NamedTuple):
    label: str
    column: str
    colour: str
    factor: float = 1.0


_PANELS: dict[str, tuple[str, tuple[_Curve, ...]]] = {
    "flow": (
        "flow at the rollers\n(mL/s)",
        (_Curve("inlet", "q_in_ml_s", BLUE), _Curve("outlet", "q_out_ml_s", VERMILION)),
    ),
    "pressure": (
        "pressure\n(kPa absolute)",
        (_Curve("inlet", "p_in_kpa", BLUE), _Curve("outlet", "p_out_kpa", VERMILION)),
    ),
    "speed": ("speed\n(r/min)", (_Curve("pump head", "speed_rad_s", BLUE, _RPM_PER_RAD_S),)),
    "delivered": ("delivered\n(mL)", (_Curve("vessel", "delivered_ml", VERMILION),)),
}


@overload
def plot(result: Run | Plan, *, panels: _Panel, ax: Axes | None = None) -> Axes: ...
@overload
def plot(
    result: Run | Plan,
    *,
    panels: list[_Panel] | tuple[_Panel, ...] | None = None,
    ax: Sequence[Axes] | None = None,
) -> list[Axes]: ...
def plot(
    result: Run | Plan,
    *,
    panels: _Panel | list[_Panel] | tuple[_Panel, ...] | None = None,
    ax: Axes | Sequence[Axes] | None = None,
) -> Axes | list[Axes]:
    """Draw a run or a plan over time.

    Parameters
    ----------
    result : Run or Plan
        What to draw; of a plan its predicted trace, with the last step and the volume asked for marked.
    panels : {"flow", "pressure", "speed", "delivered"} or sequence of these, optional
        Which panels, from top to bottom. By default all of a plan, and of a run all but the speed.
    ax : Axes or sequence of Axes, optional
        Where to draw: one for one panel, as many as panels otherwise. By default a new figure.

    Returns
    -------
    Axes or list of Axes
        One if `panels` is one name, otherwise a list.

    Raises
    ------
    ValueError
        If there is no such panel, or the numbers of panels and axes differ.
    ImportError
        Without matplotlib, which `pip install 'pumpmodel[plot]'` brings.
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
        names = list(panels)
    for name in names:
        if name not in _PANELS:
            message = f"panel is {name!r}; allowed: {', '.join(_PANELS)}"
            raise ValueError(message)
    axes = axes_for(names, ax)
    if isinstance(result, Plan):
        run = result.trace(dt_s=max(1e-3, (result.motion_s + result.settle_s) / _SAMPLES))
    else:
        run = result
    for name, axis in zip(names, axes, strict=True):
        label, curves = _PANELS[name]
        for curve in curves:
            values = getattr(run, curve.column) * curve.factor
            axis.plot(run.time_s, values, color=curve.colour, linewidth=1.2, label=curve.label)
        axis.set_ylabel(label)
        axis.grid(alpha=0.25)
        axis.margins(x=0)
        if isinstance(result, Plan):
            axis.axvline(result.motion_s, color="0.45", linewidth=1, linestyle=":", label="last step")
            if name == "delivered":
                asked = result.requested_ml + result.carry_in_ml
                axis.axhline(asked, color="0.45", linewidth=1, linestyle="--", label="asked for")
    for name, axis in zip(names, axes, strict=True):
        if len(_PANELS[name][1]) > 1 or (name == "delivered" and isinstance(result, Plan)):
            axis.legend(loc="upper left", bbox_to_anchor=(1.0, 1.02), frameon=False, fontsize="small")
    if axes:
        axes[-1].set_xlabel("time (s)")
    if axes and ax is None and isinstance(result, Plan):
        axes[0].set_title(
            f"{result.pump.name}: {result.planned_ml:.2f} mL at {result.cruise_flow_ml_s:.3g} mL/s",
            fontsize="medium",
        )
    return axes[0] if isinstance(panels, str) else axes


def plot_map(
    sweep: Sweep | SteadyState,
    quantity: str | ArrayLike = "outlet_max_kpa",
    *,
    label: str | None = None,
    y: ArrayLike | None = None,
    y_label: str | None = None,
    ax: Axes | None = None,
) -> Axes:
    """Draw a result of a sweep, or of a pump's steady states, as a map over speed and pump.

    Parameters
    ----------
    sweep : Sweep or SteadyState
        What `pumpmodel.sweep` returned; or `Pump.steady_state` of speeds of shape (n,), a map of one row.
    quantity : str or array_like
        Name of one of its results, or numbers of shape (pumps, speeds) computed from them; of a steady state
        (n,).
    label : str, optional
        Name and unit of the quantity; needed for numbers.
    y : array_like, optional
        What tells the pumps apart, shape (pumps,). By default the numbers of rollers if they all differ,
        otherwise the pumps' positions in the sweep.
    y_label : str, optional
        Its name and unit; needed with `y`.
    ax : Axes, optional
        Where to draw. By default a new figure.

    Returns
    -------
    Axes
        With a mesh, one cell a point, and a colour bar.

    Raises
    ------
    ValueError
        If there is no such quantity, a shape does not fit, a label is missing, or the sweep is empty.
    ImportError
        Without matplotlib, which `pip install 'pumpmodel[plot]'` brings.
    """
    values, label = _quantity(sweep, quantity, label)
    if isinstance(sweep, Sweep):
        rollers = np.array([pump.rollers for pump in sweep.pumps])
    else:
        # A steady state does not say whose it is.
        rollers, values = np.zeros(1), values[np.newaxis]
    speeds = np.asarray(sweep.speed_rpm)
    if y is not None:
        places = np.asarray(y, dtype=np.float64)
        if y_label is None:
            message = "y_label is missing; give name and unit of y"
            raise ValueError(message)
    elif isinstance(sweep, Sweep) and len(set(rollers)) == len(rollers):
        places, y_label = rollers.astype(np.float64), y_label or "rollers"
    else:
        numbers = np.arange(len(rollers), dtype=np.float64)
        places, y_label = numbers, y_label or ("pump" if isinstance(sweep, Sweep) else "")
    if places.shape != rollers.shape:
        message = f"y has shape {places.shape}; allowed: {rollers.shape}, one number a pump"
        raise ValueError(message)
    if not values.size:
        message = f"the sweep has shape {values.shape}; allowed: one pump and one speed at least"
        raise ValueError(message)

    (axis,) = axes_for(["map"], ax)
    rows, columns = np.argsort(places), np.argsort(speeds)
    mesh = axis.pcolormesh(
        _edges(speeds[columns]), _edges(places[rows]), values[np.ix_(rows, columns)], cmap="viridis"
    )
    axis.figure.colorbar(mesh, ax=axis, label=label)
    axis.set_xlabel("speed (r/min)")
    axis.set_ylabel(y_label)
    if y is None and isinstance(sweep, Sweep):
        axis.locator_params(axis="y", integer=True)
    elif y is None:
        axis.set_yticks([])
    return axis


def _quantity(
    sweep: Sweep | SteadyState, quantity: str | ArrayLike, label: str | None
) -> tuple[NDArray[Any], str]:
    shape = sweep.shape if isinstance(sweep, Sweep) else np.shape(sweep.speed_rpm)
    if not isinstance(sweep, Sweep) and len(shape) != 1:
        message = f"the steady state is of speeds of shape {shape}; allowed: (n,)"
        raise ValueError(message)
    if isinstance(quantity, str):
        if quantity not in RESULTS:
            message = f"quantity is {quantity!r}; allowed: {', '.join(RESULTS)}"
            raise ValueError(message)
        unit, name = COLUMNS[quantity]
        return getattr(sweep, quantity), label or (name if unit == "1" else f"{name} ({unit})")
    values = np.asarray(quantity, dtype=np.float64)
    if values.shape != shape:
        message = f"quantity has shape {values.shape}; allowed: that of the sweep, {shape}"
        raise ValueError(message)
    if label is None:
        message = "label is missing; give name and unit of the quantity"
        raise ValueError(message)
    return values, label


def _edges(middles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Edges of cells around `middles`, which rise: halfway, and as far outside at the ends."""
    if len(middles) == 1:
        return np.array([middles[0] - 0.5, middles[0] + 0.5])
    halfway = (middles[1:] + middles[:-1]) / 2
    return np.concatenate(([2 * middles[0] - halfway[0]], halfway, [2 * middles[-1] - halfway[-1]]))


def axes_for(names: list[str], ax: Axes | Sequence[Axes] | None) -> list[Axes]:
    """Give one of the caller's axes to each name, or those of a new figure."""
    pyplot = optional("matplotlib.pyplot", "plot")
    axes_type = optional("matplotlib.axes", "plot").Axes
    if ax is None:
        height = 1.0 + 1.5 * len(names) if len(names) > 1 else 4.0
        _, grid = pyplot.subplots(
            len(names), sharex=True, squeeze=False, figsize=(7.0, height), layout="constrained"
        )
        return list(grid[:, 0])
    axes = [ax] if isinstance(ax, axes_type) else list(ax)  # type: ignore[arg-type]
    if len(axes) != len(names):
        message = f"{len(axes)} axes for {len(names)} panels; give as many as panels"
        raise ValueError(message)
    return axes
