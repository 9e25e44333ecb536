"""Derivatives of a run by the parameters of the pump and its lines."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
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
