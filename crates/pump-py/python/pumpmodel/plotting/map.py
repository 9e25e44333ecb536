"""Maps of sweeps over speed and pump."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pumpmodel._pumpmodel import SteadyState
from pumpmodel._results import checks
from pumpmodel._results.tables import COLUMNS
from pumpmodel.choices import SteadyQuantity
from pumpmodel.plotting.axes import axes_for
from pumpmodel.sweeps import RESULTS, Sweep

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def plot_map(
    sweep: Sweep | SteadyState[Any],
    quantity: SteadyQuantity | ArrayLike = "outlet_max_kpa",
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
        Result of `pumpmodel.sweep`; or of `Pump.steady_state` at speeds of shape (n,), a map of one row.
    quantity : str or array_like
        Name of a result, or numbers computed from results: shape (pumps, speeds), or (n,) for a steady state.
    label : str, optional
        Name and unit of the quantity; needed for numbers.
    y : array_like, optional
        Number that tells the pumps apart, shape (pumps,). By default the number of rollers if all differ,
        otherwise the pump's position in the sweep.
    y_label : str, optional
        Name and unit of `y`; needed with `y`.
    ax : Axes, optional
        Axes to draw in. By default a new figure.

    Returns
    -------
    Axes
        Axes with a mesh, one cell for each point, and a colour bar.

    Raises
    ------
    ValueError
        If no quantity has this name, a shape does not fit, a label is missing, or the sweep is empty.
    ImportError
        If matplotlib is missing, which `pip install './crates/pump-py[plot]'` brings.
    """
    values, label = _quantity(sweep, quantity, label)
    if isinstance(sweep, Sweep):
        rollers = np.array([pump.rollers for pump in sweep.pumps])
    else:
        # A steady state does not name its pump.
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
        message = f"y has shape {places.shape}; allowed: {rollers.shape}, one number for each pump"
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
    sweep: Sweep | SteadyState[Any], quantity: str | ArrayLike, label: str | None
) -> tuple[NDArray[Any], str]:
    shape = sweep.shape if isinstance(sweep, Sweep) else np.shape(sweep.speed_rpm)
    if not isinstance(sweep, Sweep) and len(shape) != 1:
        message = f"the steady state has speeds of shape {shape}; allowed: (n,)"
        raise ValueError(message)
    if isinstance(quantity, str):
        unit, name = COLUMNS[checks.chosen("quantity", quantity, RESULTS)]
        return getattr(sweep, quantity), label or (name if unit == "1" else f"{name} ({unit})")
    values = np.asarray(quantity, dtype=np.float64)
    if values.shape != shape:
        message = f"quantity has shape {values.shape}; allowed: the shape of the sweep, {shape}"
        raise ValueError(message)
    if label is None:
        message = "label is missing; give name and unit of the quantity"
        raise ValueError(message)
    return values, label


def _edges(middles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return edges of cells around rising `middles`: halfway between them, and as far outside."""
    if len(middles) == 1:
        return np.array([middles[0] - 0.5, middles[0] + 0.5])
    halfway = (middles[1:] + middles[:-1]) / 2
    return np.concatenate(([2 * middles[0] - halfway[0]], halfway, [2 * middles[-1] - halfway[-1]]))
