from collections.abc import Mapping, Sequence
from types import GenericAlias
from typing import Any, ClassVar, Generic, TypeAlias, TypeVar, final, overload

import numpy as np
from matplotlib.animation import FuncAnimation
from matplotlib.axes import Axes
from numpy.typing import NDArray
from pandas import DataFrame
from typing_extensions import deprecated
from xarray import Dataset

from pumpmodel._results.sensitivity import Sensitivity
from pumpmodel._results.states import LineStates
from pumpmodel.choices import LimitedBy, Panel

from .pump import Pump

# A number of Python or NumPy.
_Number: TypeAlias = float | np.floating[Any] | np.integer[Any]
_Array: TypeAlias = NDArray[np.float64]
_Values = TypeVar("_Values", float, _Array)

@final
class Run:
    """Flows and pressures of a pump over time: columns of equal length, read-only arrays of float64.

    `Pump.simulate` and `Plan.trace` make runs. `len(run)` is the number of samples.
    """

    @property
    def time_s(self) -> _Array:
        """Time, s; shape (n,)."""
    @property
    def angle_rad(self) -> _Array:
        """Angle of the pump head, rad, unwrapped; shape (n,)."""
    @property
    def speed_rad_s(self) -> _Array:
        """Speed of the pump head, rad/s; shape (n,)."""
    @property
    def inlet_flow_ml_s(self) -> _Array:
        """Flow at the inlet rollers, mL/s; shape (n,)."""
    @property
    def outlet_flow_ml_s(self) -> _Array:
        """Flow at the outlet rollers, mL/s; shape (n,)."""
    @property
    def inlet_kpa(self) -> _Array:
        """Pressure at the inlet, kPa absolute; shape (n,)."""
    @property
    def outlet_kpa(self) -> _Array:
        """Pressure at the outlet, kPa absolute; shape (n,)."""
    @property
    def delivered_ml(self) -> _Array:
        """Volume that has passed the outlet line, mL; shape (n,)."""
    @property
    def end_state(self) -> LineStates:
        """\
        State of the lines at the last sample, from which another run may go on. A run of the roller-centric model or of
        `from_dict` has none and raises AttributeError.
        """
    @property
    def sensitivity(self) -> Sensitivity:
        """\
        Derivatives of pressures and delivered volume. A run of `Pump.simulate` that was not asked for them has none and
        raises AttributeError.
        """
    @property
    @deprecated("use inlet_flow_ml_s")
    def q_in_ml_s(self) -> _Array:
        """Deprecated name of `inlet_flow_ml_s`."""
    @property
    @deprecated("use outlet_flow_ml_s")
    def q_out_ml_s(self) -> _Array:
        """Deprecated name of `outlet_flow_ml_s`."""
    @property
    @deprecated("use inlet_kpa")
    def p_in_kpa(self) -> _Array:
        """Deprecated name of `inlet_kpa`."""
    @property
    @deprecated("use outlet_kpa")
    def p_out_kpa(self) -> _Array:
        """Deprecated name of `outlet_kpa`."""
    @staticmethod
    def from_dict(data: Mapping[str, Any] | DataFrame) -> Run:
        """Return the run of the columns that `to_dict` gave.

        Parameters
        ----------
        data : mapping or pandas.DataFrame
            Eight columns by their names, or by those of the command's `--trace`; array_like of equal length. The
            columns of sensitivities may stand beside them, all or none.

        Raises
        ------
        TypeError
            If `data` has no columns by name.
        ValueError
            If a column is missing, unknown or given by both names, if its length differs, if a number is not finite, or
            if the times do not rise.
        """
    def to_dict(self) -> dict[str, _Array]:
        """Return the columns by their names.

        Returns
        -------
        dict
            Read-only arrays of shape (n,), without a copy. A run with sensitivities has their columns too, as
            `run.sensitivity.to_dict` names them.
        """
    def to_dataframe(self) -> DataFrame:
        """Return the columns as a table. Needs pandas.

        Returns
        -------
        pandas.DataFrame
            Table of the columns of `to_dict`, each of shape (n,). `attrs["units"]` has their units.

        Raises
        ------
        ImportError
            If pandas is not installed: `pip install "./crates/pump-py[dataframe]"`.
        """
    def to_xarray(self) -> Dataset:
        """Return the columns over `time_s`. Needs xarray.

        Returns
        -------
        xarray.Dataset
            One variable for each column of `to_dict`, of shape (n,), over the coordinate `time_s`. Each has the
            attributes `units` and `long_name`.

        Raises
        ------
        ImportError
            If xarray is not installed: `pip install "./crates/pump-py[xarray]"`.
        """
    @overload
    def plot(self, *, panels: Panel, ax: Axes | None = None) -> Axes:
        """Draw the columns over time, as `pumpmodel.plot` does."""
    @overload
    def plot(
        self, *, panels: list[Panel] | tuple[Panel, ...] | None = None, ax: Sequence[Axes] | None = None
    ) -> list[Axes]: ...
    def _repr_html_(self) -> str:
        """Return what a notebook shows: a table of the main numbers and a small picture, as HTML."""
    def __len__(self) -> int: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    __hash__: ClassVar[None]  # type: ignore[assignment]

@final
class SteadyState(Generic[_Values]):
    """Periodic steady state of a pump at constant speed, without any trace of the start.

    `Pump.steady_state` makes steady states. The attributes are floats if the speed was one number, otherwise read-only
    arrays of the speeds' shape.
    """

    @classmethod
    def __class_getitem__(cls, key: Any) -> GenericAlias: ...
    def to_dict(self) -> dict[str, _Values]:
        """Return the attributes by their names.

        Returns
        -------
        dict
            Floats or read-only arrays, without a copy.
        """
    def to_dataframe(self) -> DataFrame:
        """Return a table with one row for each speed, in C order. Needs pandas.

        Returns
        -------
        pandas.DataFrame
            One column for each attribute. `attrs["units"]` has their units.

        Raises
        ------
        ImportError
            If pandas is not installed: `pip install "./crates/pump-py[dataframe]"`.
        """
    def to_xarray(self) -> Dataset:
        """Return the attributes over the speed. Needs xarray.

        Returns
        -------
        xarray.Dataset
            One variable for each attribute, of the speeds' shape; speeds of one dimension are the coordinate
            `speed_rpm`. Each has the attributes `units` and `long_name`.

        Raises
        ------
        ImportError
            If xarray is not installed: `pip install "./crates/pump-py[xarray]"`.
        """
    def plot(self, *, ax: Axes | Sequence[Axes] | None = None) -> list[Axes]:
        """Draw pressures with their range, mean flow and ripple over the speed.

        Parameters
        ----------
        ax : Axes or sequence of Axes, optional
            Axes for pressures, flow and ripple, or axes for the pressures alone. By default a new figure.

        Returns
        -------
        list of Axes
            Axes of the panels.

        Raises
        ------
        ValueError
            If there is no speed, or the number of axes is neither 1 nor 3.
        ImportError
            If matplotlib is missing, which `pip install './crates/pump-py[plot]'` brings.
        """
    def _repr_html_(self) -> str:
        """Return what a notebook shows: a table of the main numbers and a small picture, as HTML."""
    @property
    def speed_rpm(self) -> _Values:
        """Speed of the pump head, r/min; negative in reverse."""
    @property
    def inlet_min_kpa(self) -> _Values:
        """Smallest inlet pressure, kPa absolute."""
    @property
    def inlet_max_kpa(self) -> _Values:
        """Largest inlet pressure, kPa absolute."""
    @property
    def inlet_mean_kpa(self) -> _Values:
        """Mean inlet pressure, kPa absolute."""
    @property
    def outlet_min_kpa(self) -> _Values:
        """Smallest outlet pressure, kPa absolute."""
    @property
    def outlet_max_kpa(self) -> _Values:
        """Largest outlet pressure, kPa absolute."""
    @property
    def outlet_mean_kpa(self) -> _Values:
        """Mean outlet pressure, kPa absolute."""
    @property
    def mean_flow_ml_s(self) -> _Values:
        """Mean flow, mL/s; negative in reverse."""
    @property
    def ripple_peak_to_peak(self) -> _Values:
        """(Largest - smallest) / mean of the flow at the outlet rollers."""
    @property
    def ripple_rms(self) -> _Values:
        """Standard deviation / mean of the flow at the outlet rollers."""
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    __hash__: ClassVar[None]  # type: ignore[assignment]

@final
class Plan:
    """A planned dose, made by `Doser.plan`.

    Volumes are negative in reverse. Angles are of the pump head, unwrapped. Times count from the start of motion.
    """

    @property
    def pump(self) -> Pump:
        """Pump of the plan."""
    @property
    def requested_ml(self) -> float:
        """Requested volume, mL."""
    @property
    def carry_in_ml(self) -> float:
        """Carry from earlier doses, mL, positive toward the outlet."""
    @property
    def planned_ml(self) -> float:
        """Volume of the planned steps after the line has settled, mL.

        It is the middle of `volume_least_ml` and `volume_most_ml`.
        """
    @property
    def volume_least_ml(self) -> float:
        """Smallest volume of the planned steps over all possible start angles, mL."""
    @property
    def volume_most_ml(self) -> float:
        """Largest volume of the planned steps over all possible start angles, mL."""
    @property
    def carry_ml(self) -> float:
        """Carry to the next dose, mL: requested + carry_in + retracted - planned, positive toward the outlet."""
    @property
    def expanded_uncertainty_ml(self) -> float:
        """Expanded uncertainty of the volume, mL: 95.45 % of doses lie within it."""
    @property
    def steps(self) -> int:
        """Number of motor steps of the dose, negative in reverse; `retract_steps` has those of its retraction."""
    @property
    def retract_steps(self) -> int:
        """Number of motor steps of the retraction, negative; 0 without one."""
    @property
    def retraction_ml(self) -> float:
        """Volume that is sucked back after the dose, mL; 0 without a retraction."""
    @property
    def steps_per_rev(self) -> float:
        """Motor steps per revolution of the pump head."""
    @property
    def start_angle_rad(self) -> float:
        """Angle of the rollers at the start, rad."""
    @property
    def start_half_width_rad(self) -> float:
        """Half width of the start angle, rad: the true angle lies within it on either side of `start_angle_rad`."""
    @property
    def end_angle_rad(self) -> float:
        """Angle of the rollers at the end, before a retraction, rad, counted on from the start angle."""
    @property
    def cruise_speed_rpm(self) -> float:
        """Speed of the pump head while cruising, r/min. A smooth flow has its mean over time."""
    @property
    def peak_speed_rpm(self) -> float:
        """Fastest speed of the pump head, r/min."""
    @property
    def cruise_flow_ml_s(self) -> float:
        """Average flow at the cruise speed, mL/s."""
    @property
    def mean_flow_ml_s(self) -> float:
        """Planned volume over the time of motion, mL/s."""
    @property
    def motion_s(self) -> float:
        """Time from the start to the last step of the dose, s."""
    @property
    def settle_s(self) -> float | None:
        """Time from the last step of the dose until the undelivered volume stays below 1 µL, s. None if the outlet's
        line is not known.
        """
    @property
    def settled_s(self) -> float:
        """Time from the start until the line has settled after the last step, that of the retraction included, s."""
    @property
    def backflow_ml(self) -> float | None:
        """Largest volume delivered less the final one, mL: the line swings at the stop. It is predicted."""
    @property
    def reverse_flow_ml(self) -> float | None:
        """All that the line takes back from the vessel on the way, mL."""
    @property
    def inlet_min_kpa(self) -> float | None:
        """Smallest predicted inlet pressure, kPa absolute. None if the line is not known."""
    @property
    def inlet_max_kpa(self) -> float | None:
        """Largest predicted inlet pressure, kPa absolute. None if the line is not known."""
    @property
    def outlet_min_kpa(self) -> float | None:
        """Smallest predicted outlet pressure, kPa absolute. None if the line is not known."""
    @property
    def outlet_max_kpa(self) -> float | None:
        """Largest predicted outlet pressure, kPa absolute. None if the line is not known."""
    @property
    def limited_by(self) -> LimitedBy:
        """Limit that keeps the dose from being faster.

        "none": the dose cruises as asked. "acceleration": the acceleration keeps it slower. The fastest dose also has
        "speed" and "torque", and the port at which a pressure binds: "inlet_suction" and "outlet_suction" by the
        smallest pressure allowed there, "inlet_pressure" and "outlet_pressure" by the largest.
        """
    @property
    def ripple_before(self) -> tuple[float, float]:
        """\
        Ripple of the flow at the outlet's rollers at constant speed, over its mean: (peak to peak, root mean square).
        """
    @property
    def ripple_after(self) -> tuple[float, float]:
        """Ripple of the flow at the outlet's rollers as planned, over its mean: (peak to peak, root mean square).

        It is less than `ripple_before` with a smooth flow.
        """
    @property
    def warnings(self) -> list[str]:
        """Warnings to read before the plan is run."""
    @property
    def step_times_s(self) -> _Array:
        """\
        Time of every motor step, s; read-only, shape (abs(steps) + abs(retract_steps),). The retraction begins once the
        line has settled after the dose.
        """
    @property
    def step_directions(self) -> _Array:
        """Direction of every motor step: 1 forward, -1 in reverse; read-only, of the shape of `step_times_s`."""
    @property
    def step_angles_rad(self) -> _Array:
        """Angle of the pump head after every step, rad; read-only, of the shape of `step_times_s`."""
    @property
    def uncertainty_budget(self) -> list[dict[str, Any]]:
        """Sources of the volume's uncertainty: dicts of `source`, `standard_ml` (standard uncertainty, mL),
        `variance_percent` (share of the variance) and `remedy`.
        """
    def to_dataframe(self) -> DataFrame:
        """Return every step, as `dose --steps` writes them. Needs pandas.

        Returns
        -------
        pandas.DataFrame
            Columns `step`, `time_s`, `direction` and `angle_rad` (after the step), one row for each step of the dose
            and of its retraction. `attrs["units"]` has their units.

        Raises
        ------
        ImportError
            If pandas is not installed: `pip install "./crates/pump-py[dataframe]"`.
        """
    def to_xarray(self) -> Dataset:
        """Return every step, as `dose --steps` writes them. Needs xarray.

        Returns
        -------
        xarray.Dataset
            Variables `direction` and `angle_rad` (after the step) over `time_s`. Attributes have the units.

        Raises
        ------
        ImportError
            If xarray is not installed: `pip install "./crates/pump-py[xarray]"`.
        """
    def trace(self, *, dt_s: _Number = 1e-3) -> Run:
        """Predict flows and pressures over the dose and its retraction, from lines at rest until they have settled.

        Parameters
        ----------
        dt_s : float
            Time between samples, s. The last step and the end have their own samples.

        Returns
        -------
        Run
            Flows and pressures over time.

        Raises
        ------
        ValueError
            If `dt_s` is not positive, or if more than 1e9 samples would result.
        PumpError
            If the solver fails on the way.
        MemoryError
            If there is no room for the samples.

        Warns
        -----
        UserWarning
            If a pressure is below 0 kPa absolute, where every liquid cavitates and the model has no meaning, also
            between two samples. `Plan.warnings` says it too, beside all else that is doubtful.
        """
    def to_dict(self) -> dict[str, Any]:
        """Return the plan as the command reports a dry run: the object `dose/1` of its JSON.

        Returns
        -------
        dict
            Numbers, texts, lists and dicts only. Angles are in deg, and `delivered_ml` is None.
        """
    @overload
    def plot(self, *, panels: Panel, ax: Axes | None = None) -> Axes:
        """Draw the columns over time, as `pumpmodel.plot` does."""
    @overload
    def plot(
        self, *, panels: list[Panel] | tuple[Panel, ...] | None = None, ax: Sequence[Axes] | None = None
    ) -> list[Axes]: ...
    def animate(self, *, slower: float = 1.0, frames_per_s: float = 25.0) -> FuncAnimation:
        """Return an animation of the head over the dose, as `pumpmodel.animate` makes it."""
    def _repr_html_(self) -> str:
        """Return what a notebook shows: a table of the main numbers and a small picture, as HTML."""
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
