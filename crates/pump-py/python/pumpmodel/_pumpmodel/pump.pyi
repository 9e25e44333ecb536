import os
from collections.abc import Callable, Sequence
from typing import Any, Literal, TypeAlias, final, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray
from typing_extensions import deprecated

from pumpmodel._results.harmonics import Harmonics
from pumpmodel._results.states import LineStates
from pumpmodel.choices import Begin, Initial, Method, Model, Port, Variant
from pumpmodel.volume_fit import VolumeFit

from .results import Run, SteadyState

# A number of Python or NumPy.
_Number: TypeAlias = float | np.floating[Any] | np.integer[Any]
_Array: TypeAlias = NDArray[np.float64]
# Arguments that become an array; a single number stays a number.
_Numbers: TypeAlias = NDArray[np.floating[Any] | np.integer[Any]] | Sequence[Any] | Series[Any]

@final
class Line:
    """\
    Hydraulic line between the rollers and a reservoir: compliance at the pump, resistance and inertance in series.

    Parameters
    ----------
    resistance_kpa_s_ml : float
        R, kPa s/mL, zero or more.
    compliance_ml_kpa : float
        C, mL/kPa, more than zero.
    inertance_kpa_s2_ml : float
        L, kPa s²/mL, more than zero.
    reservoir_kpa : float
        Pressure of the reservoir, kPa absolute, more than zero.

    Raises
    ------
    ValueError
        If a value is outside its range.

    Examples
    --------
    >>> import pumpmodel as pm
    >>> line = pm.Line(
    ...     resistance_kpa_s_ml=0.1108, compliance_ml_kpa=0.0361, inertance_kpa_s2_ml=0.0042, reservoir_kpa=88.637
    ... )
    >>> line == pm.Pump.three_roller().outlet
    True
    """

    def __new__(
        cls,
        *,
        resistance_kpa_s_ml: _Number,
        compliance_ml_kpa: _Number,
        inertance_kpa_s2_ml: _Number,
        reservoir_kpa: _Number,
    ) -> Line: ...
    @property
    def resistance_kpa_s_ml(self) -> float:
        """Resistance R, kPa s/mL."""
    @property
    def compliance_ml_kpa(self) -> float:
        """Compliance C, mL/kPa."""
    @property
    def inertance_kpa_s2_ml(self) -> float:
        """Inertance L, kPa s²/mL."""
    @property
    def reservoir_kpa(self) -> float:
        """Pressure of the reservoir, kPa absolute."""
    def replace(
        self,
        *,
        resistance_kpa_s_ml: _Number | None = None,
        compliance_ml_kpa: _Number | None = None,
        inertance_kpa_s2_ml: _Number | None = None,
        reservoir_kpa: _Number | None = None,
    ) -> Line: ...
    def to_dict(self) -> dict[str, float]: ...
    def state_space(self, port: Port = "outlet") -> tuple[_Array, _Array, _Array, _Array]: ...
    def transfer_function(self, port: Port = "outlet") -> tuple[_Array, _Array]: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...

@final
class LineLikelihood:
    @overload
    def __new__(
        cls,
        pump: Pump,
        *,
        time_s: ArrayLike,
        pressure_kpa: ArrayLike,
        standard_kpa: float,
        port: Port = "outlet",
        speed_rpm: float,
        speed_rad_s: None = None,
        begin: Begin = "ramp",
        start_s: float | None = None,
        start_angle_rad: float | None = None,
    ) -> LineLikelihood: ...
    @overload
    def __new__(
        cls,
        pump: Pump,
        *,
        time_s: ArrayLike,
        pressure_kpa: ArrayLike,
        standard_kpa: float,
        port: Port = "outlet",
        speed_rpm: None = None,
        speed_rad_s: float,
        begin: Begin = "ramp",
        start_s: float | None = None,
        start_angle_rad: float | None = None,
    ) -> LineLikelihood: ...
    @property
    def line(self) -> Line: ...
    def log_likelihood(
        self,
        *,
        resistance_kpa_s_ml: float | None = None,
        compliance_ml_kpa: float | None = None,
        inertance_kpa_s2_ml: float | None = None,
        reservoir_kpa: float | None = None,
        start_angle_rad: float | None = None,
        start_s: float | None = None,
        standard_kpa: float | None = None,
    ) -> float: ...
    def __len__(self) -> int: ...

@final
class Pump:
    """A roller pump with its two lines, its motor and its fluid, as a pump file describes them.

    `Pump.three_roller`, `Pump.two_roller`, `Pump.named`, `Pump.from_toml`, `Pump.from_drawing`, `Pump.from_dict` and
    `Pump.replace` make pumps. Volumes are in mL, pressures in kPa absolute, angles in rad of the pump head. At angle 0
    a roller begins to leave the outlet.

    Examples
    --------
    >>> import pumpmodel as pm
    >>> pump = pm.Pump.three_roller()
    >>> round(pump.average_flow_ml_s(speed_rpm=100), 4)
    35.5308
    """

    @staticmethod
    def three_roller(variant: Variant = "measured") -> Pump:
        """staticmethod(function) -> method

        Convert a function to be a static method.

        A static method does not receive an implicit first argument.
        To declare a static method, use this idiom:

             class C:
                 @staticmethod
                 def f(arg1, arg2, argN):
                     ...

        It can be called either on the class (e.g. C.f()) or on an instance
        (e.g. C().f()). Both the class and the instance are ignored, and
        neither is passed implicitly as the first argument to the method.

        Static methods in Python are similar to those found in Java or C++.
        For a more advanced concept, see the classmethod builtin.
        """
    @staticmethod
    def two_roller(variant: Variant = "measured") -> Pump:
        """staticmethod(function) -> method

        Convert a function to be a static method.

        A static method does not receive an implicit first argument.
        To declare a static method, use this idiom:

             class C:
                 @staticmethod
                 def f(arg1, arg2, argN):
                     ...

        It can be called either on the class (e.g. C.f()) or on an instance
        (e.g. C().f()). Both the class and the instance are ignored, and
        neither is passed implicitly as the first argument to the method.

        Static methods in Python are similar to those found in Java or C++.
        For a more advanced concept, see the classmethod builtin.
        """
    @staticmethod
    def from_toml(path: str | os.PathLike[str]) -> Pump:
        """staticmethod(function) -> method

        Convert a function to be a static method.

        A static method does not receive an implicit first argument.
        To declare a static method, use this idiom:

             class C:
                 @staticmethod
                 def f(arg1, arg2, argN):
                     ...

        It can be called either on the class (e.g. C.f()) or on an instance
        (e.g. C().f()). Both the class and the instance are ignored, and
        neither is passed implicitly as the first argument to the method.

        Static methods in Python are similar to those found in Java or C++.
        For a more advanced concept, see the classmethod builtin.
        """
    @staticmethod
    def named(name: str) -> Pump:
        """staticmethod(function) -> method

        Convert a function to be a static method.

        A static method does not receive an implicit first argument.
        To declare a static method, use this idiom:

             class C:
                 @staticmethod
                 def f(arg1, arg2, argN):
                     ...

        It can be called either on the class (e.g. C.f()) or on an instance
        (e.g. C().f()). Both the class and the instance are ignored, and
        neither is passed implicitly as the first argument to the method.

        Static methods in Python are similar to those found in Java or C++.
        For a more advanced concept, see the classmethod builtin.
        """
    @staticmethod
    def from_drawing(
        id: str,
        *,
        rollers: int,
        bore_radius_mm: _Number,
        tube_outer_radius_mm: _Number,
        backplate_radius_mm: _Number,
        contact_angle_deg: _Number,
        roller_radius_mm: _Number,
        roller_offset_mm: _Number,
        hose_length_mm: _Number,
    ) -> Pump:
        """staticmethod(function) -> method

        Convert a function to be a static method.

        A static method does not receive an implicit first argument.
        To declare a static method, use this idiom:

             class C:
                 @staticmethod
                 def f(arg1, arg2, argN):
                     ...

        It can be called either on the class (e.g. C.f()) or on an instance
        (e.g. C().f()). Both the class and the instance are ignored, and
        neither is passed implicitly as the first argument to the method.

        Static methods in Python are similar to those found in Java or C++.
        For a more advanced concept, see the classmethod builtin.
        """
    @staticmethod
    def from_ml_per_rev(
        id: str,
        *,
        ml_per_rev: _Number,
        rollers: int,
        tube_bore_mm: _Number | None = None,
        inlet: Line | None = None,
        outlet: Line | None = None,
    ) -> Pump:
        """staticmethod(function) -> method

        Convert a function to be a static method.

        A static method does not receive an implicit first argument.
        To declare a static method, use this idiom:

             class C:
                 @staticmethod
                 def f(arg1, arg2, argN):
                     ...

        It can be called either on the class (e.g. C.f()) or on an instance
        (e.g. C().f()). Both the class and the instance are ignored, and
        neither is passed implicitly as the first argument to the method.

        Static methods in Python are similar to those found in Java or C++.
        For a more advanced concept, see the classmethod builtin.
        """
    @staticmethod
    def from_dict(data: dict[str, Any]) -> Pump:
        """staticmethod(function) -> method

        Convert a function to be a static method.

        A static method does not receive an implicit first argument.
        To declare a static method, use this idiom:

             class C:
                 @staticmethod
                 def f(arg1, arg2, argN):
                     ...

        It can be called either on the class (e.g. C.f()) or on an instance
        (e.g. C().f()). Both the class and the instance are ignored, and
        neither is passed implicitly as the first argument to the method.

        Static methods in Python are similar to those found in Java or C++.
        For a more advanced concept, see the classmethod builtin.
        """
    def to_toml(self) -> str:
        """Return the pump as the text of a pump file.

        Returns
        -------
        str
            TOML that `from_toml` reads back as an equal pump.
        """
    def to_dict(self) -> dict[str, Any]:
        """Return the pump as plain data: the tables of its pump file.

        Returns
        -------
        dict
            Numbers, texts, lists and dicts only, under the keys of a pump file.
        """
    def replace(
        self,
        *,
        id: str | None = None,
        name: str | None = None,
        rollers: int | None = None,
        inlet: Line | None = None,
        outlet: Line | None = None,
        roller_volume: VolumeFit | Literal["drawing"] | None = None,
    ) -> Pump:
        """Return this pump with some parts replaced. A part that is left out stays.

        Other rollers make another head, whose record is its own: without an `id` its id ends with a number of that
        head, and without a `name` its name tells the rollers.

        Parameters
        ----------
        id : str, optional
            Name in records.
        name : str, optional
            Name for people.
        rollers : int, optional
            Number of rollers.
        inlet : Line, optional
            Line from the inlet's reservoir to the pump.
        outlet : Line, optional
            Line from the pump to the outlet's reservoir.
        roller_volume : VolumeFit or "drawing", optional
            Volume of a roller from measured points, or from the pump's dimensions.

        Raises
        ------
        ValueError
            If the pump cannot work, for example because its rollers leave the tube open.
        """
    def check(self) -> str:
        """Check the pump as `dose pumps check` does, and say what it gives.

        Returns
        -------
        str
            A line each for head, volumes, flows, speeds, motor, fluid, lines and uncertainty, with their units, and for
            each of `warnings`.

        Raises
        ------
        ValueError
            If the pump cannot work.
        """
    @property
    def warnings(self) -> list[str]:
        """\
        Warnings of values that are possible and unusual, mostly a slip of a unit or a digit, or rollers that overlap in
        space. Every way to a pump gives them as Python warnings too.
        """
    @property
    def is_estimated(self) -> bool:
        """True if the pump's volumes follow from a drawing, or from a volume per revolution, that no measurement has
        confirmed.
        """
    @property
    def roller_volume_ml(self) -> float:
        """Volume that a roller displaces as it engages, V_r, mL."""
    @property
    def engagement_rad(self) -> float:
        """Angle over which a roller engages, phi, rad."""
    @property
    def bore_radius_mm(self) -> float:
        """Inner radius of the tube r_i, mm."""
    @property
    def tube_outer_radius_mm(self) -> float:
        """Outer radius of the tube r_o, mm."""
    @property
    def backplate_radius_mm(self) -> float:
        """Radius of the backplate (raceway) r_b, mm."""
    @property
    def contact_angle_rad(self) -> float:
        """Contact angle beta, rad: the backplate spans pi + 2 beta."""
    @property
    def roller_radius_mm(self) -> float:
        """Radius of a roller r_roller, mm."""
    @property
    def roller_offset_mm(self) -> float:
        """Distance from the shaft to a roller's axis r_offset, mm."""
    @property
    def rollers_overlap_mm(self) -> float | None:
        """Depth by which neighbouring rollers overlap in space, mm. None if they do not.

        The model computes a head whose rollers overlap, but nobody can build it.
        """
    @property
    def inlet_phase_rad(self) -> float:
        """Inlet phase psi, rad: the inlet's pulse begins this far behind the outlet's.

        Between the two a roller stays fully engaged for `2*pi - engagement_rad - inlet_phase_rad`.
        """
    @property
    def id(self) -> str:
        """Name of the pump in records and reports."""
    @property
    def name(self) -> str:
        """Name for people."""
    @property
    def rollers(self) -> int:
        """Number of rollers."""
    @property
    def pitch_rad(self) -> float:
        """Angle between rollers, rad: the period of the flow."""
    @property
    def volume_per_revolution_ml(self) -> float:
        """Volume of a revolution, mL."""
    @property
    def inlet(self) -> Line:
        """Line from the inlet's reservoir to the pump."""
    @property
    def outlet(self) -> Line:
        """Line from the pump to the outlet's reservoir."""
    @property
    def steps_per_rev(self) -> float:
        """Motor steps per revolution of the pump head, gear included."""
    @property
    def max_speed_rpm(self) -> float:
        """Fastest speed of the pump head, r/min."""
    @property
    def max_acceleration_rad_s2(self) -> float:
        """Largest acceleration of the pump head, rad/s²."""
    @property
    def default_rate_ml_s(self) -> float:
        """Rate of a dose that names no rate, speed or time, mL/s."""
    @overload
    def average_flow_ml_s(
        self, *, speed_rpm: _Number | None = None, speed_rad_s: _Number | None = None
    ) -> float:
        """Return the flow averaged over whole pitches.

        Parameters
        ----------
        speed_rpm : float or array_like
            Speed of the pump head, r/min; negative in reverse.
        speed_rad_s : float or array_like
            Speed of the pump head, rad/s. Give exactly one of `speed_rpm` and `speed_rad_s`.

        Returns
        -------
        float or numpy.ndarray
            Flow, mL/s, negative in reverse. Array input gives an array of float64 of its shape.

        Raises
        ------
        ValueError
            If not exactly one speed is given, or a speed is not finite or beyond 1e4 rad/s.
        """
    @overload
    def average_flow_ml_s(self, *, speed_rpm: _Numbers, speed_rad_s: None = None) -> _Array: ...
    @overload
    def average_flow_ml_s(self, *, speed_rpm: None = None, speed_rad_s: _Numbers) -> _Array: ...
    @overload
    def speed_for_flow_rpm(self, *, flow_ml_s: _Number) -> float:
        """Return the speed of the pump head for an average flow: the inverse of `average_flow_ml_s(speed_rpm=...)`.

        Parameters
        ----------
        flow_ml_s : float or array_like
            Average flow, mL/s; negative in reverse.

        Returns
        -------
        float or numpy.ndarray
            Speed, r/min, which may exceed `max_speed_rpm`. Array input gives an array of float64 of its shape.

        Raises
        ------
        ValueError
            If the flow is not finite or beyond 1e6 mL/s.
        """
    @overload
    def speed_for_flow_rpm(self, *, flow_ml_s: _Numbers) -> _Array: ...
    @overload
    def outlet_volume_ml(self, angle_rad: _Number) -> float:
        """Return the volume that the outlet rollers deliver from angle 0 to `angle_rad`.

        Parameters
        ----------
        angle_rad : float or array_like
            Angle of the pump head, rad, unwrapped.

        Returns
        -------
        float or numpy.ndarray
            Volume, mL. Array input gives an array of float64 of its shape.

        Raises
        ------
        ValueError
            If an angle is not finite or beyond 1e9 rad.
        """
    @overload
    def outlet_volume_ml(self, angle_rad: _Numbers) -> _Array: ...
    @overload
    def angle_for_volume(self, volume_ml: _Number, start_angle_rad: _Number = 0.0) -> float: ...
    @overload
    def angle_for_volume(self, volume_ml: _Numbers, start_angle_rad: _Number | _Numbers = 0.0) -> _Array: ...
    @overload
    def angle_for_volume(self, volume_ml: _Number, start_angle_rad: _Numbers) -> _Array: ...
    @overload
    def outlet_flow_ml_rad(self, angle_rad: _Number) -> float: ...
    @overload
    def outlet_flow_ml_rad(self, angle_rad: _Numbers) -> _Array: ...
    @overload
    def inlet_volume_ml(self, angle_rad: _Number) -> float:
        """Return the volume that the inlet rollers take in from angle 0 to `angle_rad`, mL.

        Parameters
        ----------
        angle_rad : float or array_like
            Angle of the pump head, rad, unwrapped.

        Returns
        -------
        float or numpy.ndarray
            Volume, mL. Array input gives an array of float64 of its shape.

        Raises
        ------
        ValueError
            If an angle is not finite or beyond 1e9 rad.
        """
    @overload
    def inlet_volume_ml(self, angle_rad: _Numbers) -> _Array: ...
    @overload
    def inlet_flow_ml_rad(self, angle_rad: _Number) -> float:
        """Return the flow at the inlet rollers per angle, mL/rad.

        Parameters
        ----------
        angle_rad : float or array_like
            Angle of the pump head, rad, unwrapped.

        Returns
        -------
        float or numpy.ndarray
            Flow per angle, mL/rad. Array input gives an array of float64 of its shape.

        Raises
        ------
        ValueError
            If an angle is not finite or beyond 1e9 rad.
        """
    @overload
    def inlet_flow_ml_rad(self, angle_rad: _Numbers) -> _Array: ...
    @overload
    @deprecated("use average_flow_ml_s")
    def average_flow(self, *, speed_rpm: _Number | None = None, speed_rad_s: _Number | None = None) -> float:
        """Deprecated name of `average_flow_ml_s`."""
    @overload
    @deprecated("use average_flow_ml_s")
    def average_flow(self, *, speed_rpm: _Numbers, speed_rad_s: None = None) -> _Array: ...
    @overload
    @deprecated("use average_flow_ml_s")
    def average_flow(self, *, speed_rpm: None = None, speed_rad_s: _Numbers) -> _Array: ...
    @overload
    @deprecated("use speed_for_flow_rpm")
    def speed_for_flow(self, *, flow_ml_s: _Number) -> float:
        """Deprecated name of `speed_for_flow_rpm`."""
    @overload
    @deprecated("use speed_for_flow_rpm")
    def speed_for_flow(self, *, flow_ml_s: _Numbers) -> _Array: ...
    @overload
    @deprecated("use outlet_volume_ml")
    def outlet_volume(self, angle_rad: _Number) -> float:
        """Deprecated name of `outlet_volume_ml`."""
    @overload
    @deprecated("use outlet_volume_ml")
    def outlet_volume(self, angle_rad: _Numbers) -> _Array: ...
    @overload
    @deprecated("use outlet_flow_ml_rad")
    def outlet_flow_per_rad(self, angle_rad: _Number) -> float:
        """Deprecated name of `outlet_flow_ml_rad`."""
    @overload
    @deprecated("use outlet_flow_ml_rad")
    def outlet_flow_per_rad(self, angle_rad: _Numbers) -> _Array: ...
    @overload
    @deprecated("use inlet_volume_ml")
    def inlet_volume(self, angle_rad: _Number) -> float:
        """Deprecated name of `inlet_volume_ml`."""
    @overload
    @deprecated("use inlet_volume_ml")
    def inlet_volume(self, angle_rad: _Numbers) -> _Array: ...
    @overload
    @deprecated("use inlet_flow_ml_rad")
    def inlet_flow_per_rad(self, angle_rad: _Number) -> float:
        """Deprecated name of `inlet_flow_ml_rad`."""
    @overload
    @deprecated("use inlet_flow_ml_rad")
    def inlet_flow_per_rad(self, angle_rad: _Numbers) -> _Array: ...
    @overload
    def simulate(
        self,
        *,
        speed_rpm: _Number | Callable[[float], float],
        speed_rad_s: None = None,
        duration_s: _Number,
        dt_s: _Number | None = None,
        time_s: None = None,
        output_time_s: None = None,
        start_angle_rad: _Number = 0.0,
        model: Model = "flow-centric",
        method: Method = "auto",
        initial: Initial | LineStates = "rest",
        tolerance: _Number | None = None,
        segment_scale: _Number | None = None,
        distensibility_per_kpa: _Number | None = None,
        valve_resistance_kpa_s_ml: _Number | None = None,
        closure_rad: _Number | None = None,
    ) -> Run: ...
    @overload
    def simulate(
        self,
        *,
        speed_rpm: None = None,
        speed_rad_s: _Number | Callable[[float], float],
        duration_s: _Number,
        dt_s: _Number | None = None,
        time_s: None = None,
        output_time_s: None = None,
        start_angle_rad: _Number = 0.0,
        model: Model = "flow-centric",
        method: Method = "auto",
        initial: Initial | LineStates = "rest",
        tolerance: _Number | None = None,
        segment_scale: _Number | None = None,
        distensibility_per_kpa: _Number | None = None,
        valve_resistance_kpa_s_ml: _Number | None = None,
        closure_rad: _Number | None = None,
    ) -> Run: ...
    @overload
    def simulate(
        self,
        *,
        speed_rpm: _Number | Callable[[float], float],
        speed_rad_s: None = None,
        duration_s: None = None,
        dt_s: None = None,
        time_s: _Numbers,
        output_time_s: None = None,
        start_angle_rad: _Number = 0.0,
        model: Model = "flow-centric",
        method: Method = "auto",
        initial: Initial | LineStates = "rest",
        tolerance: _Number | None = None,
        segment_scale: _Number | None = None,
        distensibility_per_kpa: _Number | None = None,
        valve_resistance_kpa_s_ml: _Number | None = None,
        closure_rad: _Number | None = None,
    ) -> Run: ...
    @overload
    def simulate(
        self,
        *,
        speed_rpm: None = None,
        speed_rad_s: _Number | Callable[[float], float],
        duration_s: None = None,
        dt_s: None = None,
        time_s: _Numbers,
        output_time_s: None = None,
        start_angle_rad: _Number = 0.0,
        model: Model = "flow-centric",
        method: Method = "auto",
        initial: Initial | LineStates = "rest",
        tolerance: _Number | None = None,
        segment_scale: _Number | None = None,
        distensibility_per_kpa: _Number | None = None,
        valve_resistance_kpa_s_ml: _Number | None = None,
        closure_rad: _Number | None = None,
    ) -> Run: ...
    @overload
    def simulate(
        self,
        *,
        speed_rpm: _Numbers,
        speed_rad_s: None = None,
        duration_s: None = None,
        dt_s: None = None,
        time_s: _Numbers,
        output_time_s: _Numbers | None = None,
        start_angle_rad: _Number = 0.0,
        model: Model = "flow-centric",
        method: Method = "auto",
        initial: Initial | LineStates = "rest",
        tolerance: _Number | None = None,
        segment_scale: _Number | None = None,
        distensibility_per_kpa: _Number | None = None,
        valve_resistance_kpa_s_ml: _Number | None = None,
        closure_rad: _Number | None = None,
    ) -> Run: ...
    @overload
    def simulate(
        self,
        *,
        speed_rpm: None = None,
        speed_rad_s: _Numbers,
        duration_s: None = None,
        dt_s: None = None,
        time_s: _Numbers,
        output_time_s: _Numbers | None = None,
        start_angle_rad: _Number = 0.0,
        model: Model = "flow-centric",
        method: Method = "auto",
        initial: Initial | LineStates = "rest",
        tolerance: _Number | None = None,
        segment_scale: _Number | None = None,
        distensibility_per_kpa: _Number | None = None,
        valve_resistance_kpa_s_ml: _Number | None = None,
        closure_rad: _Number | None = None,
    ) -> Run: ...
    @overload
    def harmonics(
        self, count: int = 20, *, speed_rpm: _Number, speed_rad_s: None = None, port: Port = "outlet"
    ) -> Harmonics: ...
    @overload
    def harmonics(
        self, count: int = 20, *, speed_rpm: None = None, speed_rad_s: _Number, port: Port = "outlet"
    ) -> Harmonics: ...
    @overload
    def steady_state(self, *, speed_rpm: _Number, speed_rad_s: None = None) -> SteadyState[float]: ...
    @overload
    def steady_state(self, *, speed_rpm: None = None, speed_rad_s: _Number) -> SteadyState[float]: ...
    @overload
    def steady_state(self, *, speed_rpm: _Numbers, speed_rad_s: None = None) -> SteadyState[_Array]: ...
    @overload
    def steady_state(self, *, speed_rpm: None = None, speed_rad_s: _Numbers) -> SteadyState[_Array]: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
