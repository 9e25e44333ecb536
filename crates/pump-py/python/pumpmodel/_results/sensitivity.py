"""Derivatives of a run by the parameters of the pump and its lines."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pumpmodel._pumpmodel import _numbers

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from pandas import DataFrame
    from xarray import Dataset

# Parameter, its unit and what it is.
PARAMETERS = {
    "resistance_kpa_s_ml": ("kPa s/mL", "resistance of the line"),
    "compliance_ml_kpa": ("mL/kPa", "compliance of the line"),
    "inertance_kpa_s2_ml": ("kPa s²/mL", "inertance of the line"),
    "start_angle_rad": ("rad", "angle at the start"),
    "roller_volume_ml": ("mL", "roller volume"),
}


# Quantities, and the columns of their derivatives, in the order of the rows.
_QUANTITIES = ("inlet_kpa_by", "outlet_kpa_by", "delivered_ml_by")
COLUMNS = tuple(f"{quantity}_{parameter}" for quantity in _QUANTITIES for parameter in PARAMETERS)


class Sensitivity(NamedTuple):
    """Exact derivatives of a run's pressures and delivered volume, as `Run.sensitivity` has them.

    Row k of each array of shape (5, n) is the derivative by `parameters[k]`: a change of the quantity, kPa
    or mL, over a change of the parameter in its unit. Pressures are differentiated by R, C and L of their
    own port's line, and the delivered volume by those of the outlet's line. The roller volume changes in
    proportion, with its shape, and the flow between pulses stays.
    """

    #: Times of the samples, s, shape (n,).
    time_s: NDArray[np.float64]
    #: Derivatives of the pressure at the inlet, kPa over the parameter's unit, shape (5, n).
    inlet_kpa_by: NDArray[np.float64]
    #: Derivatives of the pressure at the outlet, kPa over the parameter's unit, shape (5, n).
    outlet_kpa_by: NDArray[np.float64]
    #: Derivatives of the delivered volume, mL over the parameter's unit, shape (5, n).
    delivered_ml_by: NDArray[np.float64]

    @property
    def parameters(self) -> tuple[str, ...]:
        """Names of the parameters, each with its unit, in the order of the rows."""
        return tuple(PARAMETERS)

    def to_dict(self) -> dict[str, NDArray[np.float64]]:
        """Return the derivatives by names such as "outlet_kpa_by_compliance_ml_kpa", without a copy."""
        columns = {"time_s": self.time_s}
        for name, rows in zip(self._fields[1:], self[1:], strict=True):
            for parameter, row in zip(PARAMETERS, rows, strict=True):
                columns[f"{name}_{parameter}"] = row
        return columns

    def to_dataframe(self) -> "DataFrame":
        """Return the columns of `to_dict` as a table, with units in `attrs["units"]`. Needs pandas."""
        from pumpmodel._results.tables import sensitivity_dataframe

        table: DataFrame = sensitivity_dataframe(self)
        return table

    def to_xarray(self) -> "Dataset":
        """Return the three quantities over `parameter` and `time_s`. Needs xarray."""
        from pumpmodel._results.tables import sensitivity_xarray

        dataset: Dataset = sensitivity_xarray(self)
        return dataset

    def plot(self, *, ax: "Axes | Sequence[Axes] | None" = None) -> "list[Axes]":
        """Draw the derivatives of both pressures over time, one panel for each parameter.

        Parameters
        ----------
        ax : Axes or sequence of Axes, optional
            Axes for each of the five parameters, or axes for the first alone. By default a new figure.

        Returns
        -------
        list of Axes
            Axes over the time, s, in the order of `parameters`.

        Raises
        ------
        ValueError
            If the number of axes is neither 1 nor 5.
        ImportError
            If matplotlib is missing, which `pip install './crates/pump-py[plot]'` brings.
        """
        from pumpmodel.plotting.knowledge import plot_sensitivity

        return plot_sensitivity(self, ax=ax)

    def _repr_html_(self) -> str:
        from pumpmodel._results.notebook.knowledge import sensitivity_html

        return sensitivity_html(self)


def equal(one: Sensitivity, other: Sensitivity) -> bool:
    """Tell if every derivative is equal."""
    return all(map(np.array_equal, one, other))


def from_columns(columns: dict[str, Any], time_s: NDArray[np.float64]) -> Sensitivity | None:
    """Return the derivatives among the columns of a run, or None without any.

    Raises
    ------
    ValueError
        If some are missing, their lengths differ from that of the run, or a number is not finite.
    """
    given = [name for name in COLUMNS if name in columns]
    if not given:
        return None
    missing = [name for name in COLUMNS if name not in columns]
    if missing:
        message = (
            f"the column {missing[0]} is missing; allowed: all {len(COLUMNS)} of the sensitivity, or none"
        )
        raise ValueError(message)
    arrays = []
    for quantity in _QUANTITIES:
        rows = np.empty((len(PARAMETERS), len(time_s)))
        for row, parameter in zip(rows, PARAMETERS, strict=True):
            name = f"{quantity}_{parameter}"
            numbers = np.asarray(_numbers(name, columns[name]))
            if numbers.shape != row.shape:
                message = f"{name} has the shape {numbers.shape}; allowed: {row.shape}, as the other columns"
                raise ValueError(message)
            if not np.isfinite(numbers).all():
                n = int(np.flatnonzero(~np.isfinite(numbers))[0])
                message = f"{name}[{n}] is {numbers[n]}; allowed: a finite number, in every sample"
                raise ValueError(message)
            row[:] = numbers
        rows.setflags(write=False)
        arrays.append(rows)
    return Sensitivity(time_s, *arrays)
