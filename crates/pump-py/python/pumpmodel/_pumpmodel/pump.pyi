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

_Array: TypeAlias = NDArray[np.float64]
# Arguments that become an array; a single number stays a number.
_Numbers: TypeAlias = NDArray[np.floating[Any] | np.integer[Any]] | Sequence[Any]

@final
class Line:
    def __new__(
        cls,
        *,
        resistance_kpa_s_ml: float,
        compliance_ml_kpa: float,
        inertance_kpa_s2_ml: float,
        reservoir_kpa: float,
    ) -> Line: ...
    @property
    def resistance_kpa_s_ml(self) -> float: ...
    @property
    def compliance_ml_kpa(self) -> float: ...
    @property
    def inertance_kpa_s2_ml(self) -> float: ...
    @property
    def reservoir_kpa(self) -> float: ...
    def replace(
        self,
        *,
        resistance_kpa_s_ml: float | None = None,
        compliance_ml_kpa: float | None = None,
        inertance_kpa_s2_ml: float | None = None,
        reservoir_kpa: float | None = None,
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
    @staticmethod
    def three_roller(variant: Variant = "measured") -> Pump: ...
    @staticmethod
    def two_roller(variant: Variant = "measured") -> Pump: ...
    @staticmethod
    def from_toml(path: str | os.PathLike[str]) -> Pump: ...
    @staticmethod
    def named(name: str) -> Pump: ...
    @staticmethod
    def from_drawing(
        id: str,
        *,
        rollers: int,
        bore_radius_mm: float,
        tube_outer_radius_mm: float,
        backplate_radius_mm: float,
        contact_angle_deg: float,
        roller_radius_mm: float,
        roller_offset_mm: float,
        hose_length_mm: float,
    ) -> Pump: ...
    @staticmethod
    def from_ml_per_rev(
        id: str,
        *,
        ml_per_rev: float,
        rollers: int,
        tube_bore_mm: float | None = None,
        inlet: Line | None = None,
        outlet: Line | None = None,
    ) -> Pump: ...
    @staticmethod
    def from_dict(data: dict[str, Any]) -> Pump: ...
    def to_toml(self) -> str: ...
    def to_dict(self) -> dict[str, Any]: ...
    def replace(
        self,
        *,
        id: str | None = None,
        name: str | None = None,
        rollers: int | None = None,
        inlet: Line | None = None,
        outlet: Line | None = None,
        roller_volume: VolumeFit | Literal["drawing"] | None = None,
    ) -> Pump: ...
    @property
    def is_estimated(self) -> bool: ...
    @property
    def roller_volume_ml(self) -> float: ...
    @property
    def engagement_rad(self) -> float: ...
    @property
    def bore_radius_mm(self) -> float: ...
    @property
    def tube_outer_radius_mm(self) -> float: ...
    @property
    def backplate_radius_mm(self) -> float: ...
    @property
    def contact_angle_rad(self) -> float: ...
    @property
    def roller_radius_mm(self) -> float: ...
    @property
    def roller_offset_mm(self) -> float: ...
    @property
    def rollers_overlap_mm(self) -> float | None: ...
    @property
    def inlet_phase_rad(self) -> float: ...
    @property
    def id(self) -> str: ...
    @property
    def name(self) -> str: ...
    @property
    def rollers(self) -> int: ...
    @property
    def pitch_rad(self) -> float: ...
    @property
    def volume_per_revolution_ml(self) -> float: ...
    @property
    def inlet(self) -> Line: ...
    @property
    def outlet(self) -> Line: ...
    @property
    def steps_per_rev(self) -> float: ...
    @property
    def max_speed_rpm(self) -> float: ...
    @property
    def max_acceleration_rad_s2(self) -> float: ...
    @property
    def default_rate_ml_s(self) -> float: ...
    @overload
    def average_flow_ml_s(self, *, speed_rpm: float, speed_rad_s: None = None) -> float: ...
    @overload
    def average_flow_ml_s(self, *, speed_rpm: None = None, speed_rad_s: float) -> float: ...
    @overload
    def average_flow_ml_s(self, *, speed_rpm: _Numbers, speed_rad_s: None = None) -> _Array: ...
    @overload
    def average_flow_ml_s(self, *, speed_rpm: None = None, speed_rad_s: _Numbers) -> _Array: ...
    @overload
    def speed_for_flow_rpm(self, *, flow_ml_s: float) -> float: ...
    @overload
    def speed_for_flow_rpm(self, *, flow_ml_s: _Numbers) -> _Array: ...
    @overload
    def outlet_volume_ml(self, angle_rad: float) -> float: ...
    @overload
    def outlet_volume_ml(self, angle_rad: _Numbers) -> _Array: ...
    @overload
    def angle_for_volume(self, volume_ml: float, start_angle_rad: float = 0.0) -> float: ...
    @overload
    def angle_for_volume(self, volume_ml: _Numbers, start_angle_rad: float | _Numbers = 0.0) -> _Array: ...
    @overload
    def angle_for_volume(self, volume_ml: float, start_angle_rad: _Numbers) -> _Array: ...
    @overload
    def outlet_flow_ml_rad(self, angle_rad: float) -> float: ...
    @overload
    def outlet_flow_ml_rad(self, angle_rad: _Numbers) -> _Array: ...
    @overload
    def inlet_volume_ml(self, angle_rad: float) -> float: ...
    @overload
    def inlet_volume_ml(self, angle_rad: _Numbers) -> _Array: ...
    @overload
    def inlet_flow_ml_rad(self, angle_rad: float) -> float: ...
    @overload
    def inlet_flow_ml_rad(self, angle_rad: _Numbers) -> _Array: ...
    @overload
    @deprecated("use average_flow_ml_s")
    def average_flow(self, *, speed_rpm: float, speed_rad_s: None = None) -> float: ...
    @overload
    @deprecated("use average_flow_ml_s")
    def average_flow(self, *, speed_rpm: None = None, speed_rad_s: float) -> float: ...
    @overload
    @deprecated("use average_flow_ml_s")
    def average_flow(self, *, speed_rpm: _Numbers, speed_rad_s: None = None) -> _Array: ...
    @overload
    @deprecated("use average_flow_ml_s")
    def average_flow(self, *, speed_rpm: None = None, speed_rad_s: _Numbers) -> _Array: ...
    @overload
    @deprecated("use speed_for_flow_rpm")
    def speed_for_flow(self, *, flow_ml_s: float) -> float: ...
    @overload
    @deprecated("use speed_for_flow_rpm")
    def speed_for_flow(self, *, flow_ml_s: _Numbers) -> _Array: ...
    @overload
    @deprecated("use outlet_volume_ml")
    def outlet_volume(self, angle_rad: float) -> float: ...
    @overload
    @deprecated("use outlet_volume_ml")
    def outlet_volume(self, angle_rad: _Numbers) -> _Array: ...
    @overload
    @deprecated("use outlet_flow_ml_rad")
    def outlet_flow_per_rad(self, angle_rad: float) -> float: ...
    @overload
    @deprecated("use outlet_flow_ml_rad")
    def outlet_flow_per_rad(self, angle_rad: _Numbers) -> _Array: ...
    @overload
    @deprecated("use inlet_volume_ml")
    def inlet_volume(self, angle_rad: float) -> float: ...
    @overload
    @deprecated("use inlet_volume_ml")
    def inlet_volume(self, angle_rad: _Numbers) -> _Array: ...
    @overload
    @deprecated("use inlet_flow_ml_rad")
    def inlet_flow_per_rad(self, angle_rad: float) -> float: ...
    @overload
    @deprecated("use inlet_flow_ml_rad")
    def inlet_flow_per_rad(self, angle_rad: _Numbers) -> _Array: ...
    @overload
    def simulate(
        self,
        *,
        speed_rpm: float | Callable[[float], float],
        speed_rad_s: None = None,
        duration_s: float,
        dt_s: float | None = None,
        time_s: None = None,
        output_time_s: None = None,
        start_angle_rad: float = 0.0,
        model: Model = "flow-centric",
        method: Method = "auto",
        initial: Initial | LineStates = "rest",
        tolerance: float | None = None,
        segment_scale: float | None = None,
        distensibility_per_kpa: float | None = None,
        valve_resistance_kpa_s_ml: float | None = None,
        closure_rad: float | None = None,
    ) -> Run: ...
    @overload
    def simulate(
        self,
        *,
        speed_rpm: None = None,
        speed_rad_s: float | Callable[[float], float],
        duration_s: float,
        dt_s: float | None = None,
        time_s: None = None,
        output_time_s: None = None,
        start_angle_rad: float = 0.0,
        model: Model = "flow-centric",
        method: Method = "auto",
        initial: Initial | LineStates = "rest",
        tolerance: float | None = None,
        segment_scale: float | None = None,
        distensibility_per_kpa: float | None = None,
        valve_resistance_kpa_s_ml: float | None = None,
        closure_rad: float | None = None,
    ) -> Run: ...
    @overload
    def simulate(
        self,
        *,
        speed_rpm: float | Callable[[float], float],
        speed_rad_s: None = None,
        duration_s: None = None,
        dt_s: None = None,
        time_s: _Numbers,
        output_time_s: None = None,
        start_angle_rad: float = 0.0,
        model: Model = "flow-centric",
        method: Method = "auto",
        initial: Initial | LineStates = "rest",
        tolerance: float | None = None,
        segment_scale: float | None = None,
        distensibility_per_kpa: float | None = None,
        valve_resistance_kpa_s_ml: float | None = None,
        closure_rad: float | None = None,
    ) -> Run: ...
    @overload
    def simulate(
        self,
        *,
        speed_rpm: None = None,
        speed_rad_s: float | Callable[[float], float],
        duration_s: None = None,
        dt_s: None = None,
        time_s: _Numbers,
        output_time_s: None = None,
        start_angle_rad: float = 0.0,
        model: Model = "flow-centric",
        method: Method = "auto",
        initial: Initial | LineStates = "rest",
        tolerance: float | None = None,
        segment_scale: float | None = None,
        distensibility_per_kpa: float | None = None,
        valve_resistance_kpa_s_ml: float | None = None,
        closure_rad: float | None = None,
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
        start_angle_rad: float = 0.0,
        model: Model = "flow-centric",
        method: Method = "auto",
        initial: Initial | LineStates = "rest",
        tolerance: float | None = None,
        segment_scale: float | None = None,
        distensibility_per_kpa: float | None = None,
        valve_resistance_kpa_s_ml: float | None = None,
        closure_rad: float | None = None,
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
        start_angle_rad: float = 0.0,
        model: Model = "flow-centric",
        method: Method = "auto",
        initial: Initial | LineStates = "rest",
        tolerance: float | None = None,
        segment_scale: float | None = None,
        distensibility_per_kpa: float | None = None,
        valve_resistance_kpa_s_ml: float | None = None,
        closure_rad: float | None = None,
    ) -> Run: ...
    @overload
    def harmonics(
        self, count: int = 20, *, speed_rpm: float, speed_rad_s: None = None, port: Port = "outlet"
    ) -> Harmonics: ...
    @overload
    def harmonics(
        self, count: int = 20, *, speed_rpm: None = None, speed_rad_s: float, port: Port = "outlet"
    ) -> Harmonics: ...
    @overload
    def steady_state(self, *, speed_rpm: float, speed_rad_s: None = None) -> SteadyState[float]: ...
    @overload
    def steady_state(self, *, speed_rpm: None = None, speed_rad_s: float) -> SteadyState[float]: ...
    @overload
    def steady_state(self, *, speed_rpm: _Numbers, speed_rad_s: None = None) -> SteadyState[_Array]: ...
    @overload
    def steady_state(self, *, speed_rpm: None = None, speed_rad_s: _Numbers) -> SteadyState[_Array]: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
