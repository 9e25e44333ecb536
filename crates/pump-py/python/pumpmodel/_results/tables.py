"""Results as tables of pandas and xarray, which are both optional."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from pumpmodel._pumpmodel import Plan, Run, SteadyState
from pumpmodel._results.optional import optional
from pumpmodel._results.sensitivity import COLUMNS as SENSITIVITIES
from pumpmodel._results.sensitivity import PARAMETERS, Sensitivity

# Unit ("1" is none) and description of each column.
COLUMNS = {
    "time_s": ("s", "time"),
    "angle_rad": ("rad", "angle of the pump head"),
    "speed_rad_s": ("rad/s", "speed of the pump head"),
    "inlet_flow_ml_s": ("mL/s", "flow at the inlet rollers"),
    "outlet_flow_ml_s": ("mL/s", "flow at the outlet rollers"),
    "inlet_kpa": ("kPa", "pressure at the inlet, absolute"),
    "outlet_kpa": ("kPa", "pressure at the outlet, absolute"),
    "delivered_ml": ("mL", "volume that has passed the outlet line"),
    "step": ("1", "number of the motor step"),
    "direction": ("1", "direction of the step: 1 forward, -1 reverse"),
    "speed_rpm": ("r/min", "speed of the pump head"),
    "inlet_min_kpa": ("kPa", "smallest inlet pressure, absolute"),
    "inlet_max_kpa": ("kPa", "largest inlet pressure, absolute"),
    "inlet_mean_kpa": ("kPa", "mean inlet pressure, absolute"),
    "outlet_min_kpa": ("kPa", "smallest outlet pressure, absolute"),
    "outlet_max_kpa": ("kPa", "largest outlet pressure, absolute"),
    "outlet_mean_kpa": ("kPa", "mean outlet pressure, absolute"),
    "mean_flow_ml_s": ("mL/s", "mean flow"),
    "ripple_peak_to_peak": ("1", "(largest - smallest)/mean of the flow at the outlet rollers"),
    "ripple_rms": ("1", "standard deviation/mean of the flow at the outlet rollers"),
}


# Derivatives of a run, as `Run.to_dict` names them.
for _name in SENSITIVITIES:
    _quantity, _parameter = _name.split("_by_")
    _units, _long_name = COLUMNS[_quantity]
    _unit, _of = PARAMETERS[_parameter]
    COLUMNS[_name] = (f"{_units}/({_unit})", f"derivative of the {_long_name} by the {_of}")


def _dataframe(columns: dict[str, Any], make: Any = None) -> Any:
    frame = (make or optional("pandas", "dataframe").DataFrame)(columns)
    frame.attrs["units"] = {name: COLUMNS[name][0] for name in columns}
    return frame


def _dataset(
    dims: tuple[str, ...], coordinates: dict[str, Any], variables: dict[str, Any], make: Any = None
) -> Any:
    def described(name: str, numbers: Any) -> tuple[tuple[str, ...], Any, dict[str, str]]:
        units, long_name = COLUMNS[name]
        return dims, numbers, {"units": units, "long_name": long_name}

    return (make or optional("xarray", "xarray").Dataset)(
        {name: described(name, numbers) for name, numbers in variables.items()},
        coords={name: described(name, numbers) for name, numbers in coordinates.items()},
    )


def run_dataframe(run: Run) -> Any:
    """Return the columns of a run as a table."""
    optional("pandas", "dataframe")
    from pumpmodel._results.frame import RunFrame

    return _dataframe(run.to_dict(), RunFrame)


def run_xarray(run: Run) -> Any:
    """Return the columns of a run over time."""
    optional("xarray", "xarray")
    from pumpmodel._results.dataset import RunDataset

    columns = run.to_dict()
    return _dataset(("time_s",), {"time_s": columns.pop("time_s")}, columns, RunDataset)


def _directions(plan: Plan) -> NDArray[np.int64]:
    return plan.step_directions.astype(np.int64)


def plan_dataframe(plan: Plan) -> Any:
    """Return the steps of a plan as a table, those of its retraction last."""
    return _dataframe(
        {
            "step": np.arange(1, len(plan.step_times_s) + 1),
            "time_s": plan.step_times_s,
            "direction": _directions(plan),
            "angle_rad": plan.step_angles_rad,
        }
    )


def plan_xarray(plan: Plan) -> Any:
    """Return the steps of a plan over time."""
    variables = {"direction": _directions(plan), "angle_rad": plan.step_angles_rad}
    return _dataset(("time_s",), {"time_s": plan.step_times_s}, variables)


def steady_dataframe(steady: SteadyState[Any]) -> Any:
    """Return a table with one row for each speed."""
    return _dataframe({name: np.ravel(numbers) for name, numbers in steady.to_dict().items()})


def steady_xarray(steady: SteadyState[Any]) -> Any:
    """Return the attributes of a steady state over the speed."""
    columns = steady.to_dict()
    speeds = np.asarray(columns.pop("speed_rpm"))
    dims = ("speed_rpm",) if speeds.ndim == 1 else tuple(f"dim_{n}" for n in range(speeds.ndim))
    return _dataset(dims, {"speed_rpm": speeds}, columns)


def sensitivity_dataframe(sensitivity: Sensitivity) -> Any:
    """Return the derivatives of a run as a table, with their units."""
    frame = optional("pandas", "dataframe").DataFrame(sensitivity.to_dict())
    units = {"time_s": "s"}
    for name in sensitivity._fields[1:]:
        quantity = COLUMNS[name.removesuffix("_by")][0]
        for parameter, (unit, _) in PARAMETERS.items():
            units[f"{name}_{parameter}"] = f"{quantity}/({unit})"
    frame.attrs["units"] = units
    return frame


def sensitivity_xarray(sensitivity: Sensitivity) -> Any:
    """Return the derivatives of a run over parameters and time."""
    variables = {}
    for name in sensitivity._fields[1:]:
        units, long_name = COLUMNS[name.removesuffix("_by")]
        described = {"units": units, "long_name": f"derivative of the {long_name}"}
        variables[name] = (("parameter", "time_s"), getattr(sensitivity, name), described)
    units_of = [unit for unit, _ in PARAMETERS.values()]
    return optional("xarray", "xarray").Dataset(
        variables,
        coords={
            "parameter": ("parameter", list(PARAMETERS), {"long_name": "parameter, with its unit"}),
            "parameter_unit": ("parameter", units_of),
            "time_s": ("time_s", sensitivity.time_s, {"units": "s", "long_name": "time"}),
        },
    )
