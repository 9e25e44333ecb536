import os
from collections.abc import Sequence
from typing import Any, TypeAlias, final, overload

import numpy as np
from numpy.typing import NDArray

from pumpmodel.choices import CalibrationFit, Finish, Ramps
from pumpmodel.weighed import WeighedRun

from .pump import Pump
from .results import Plan

_Array: TypeAlias = NDArray[np.float64]
# Arguments that become an array; a single number stays a number.
_Numbers: TypeAlias = NDArray[np.floating[Any] | np.integer[Any]] | Sequence[Any]

@final
class Limits:
    def __new__(
        cls, *, max_outlet_kpa: float | None = None, min_inlet_kpa: float | None = None
    ) -> Limits: ...
    @property
    def max_outlet_kpa(self) -> float | None: ...
    @property
    def min_inlet_kpa(self) -> float | None: ...
    def to_dict(self) -> dict[str, float | None]: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...

@final
class Calibration:
    @staticmethod
    def from_runs(
        pump: Pump, runs: Sequence[WeighedRun], *, scale: str | None = None, fit: CalibrationFit = "best"
    ) -> Calibration: ...
    @staticmethod
    def from_csv(
        pump: Pump, path: str | os.PathLike[str], *, scale: str | None = None, fit: CalibrationFit = "best"
    ) -> Calibration: ...
    @staticmethod
    def from_dict(data: dict[str, Any]) -> Calibration: ...
    def to_dict(self) -> dict[str, Any]: ...
    @overload
    def displacement_factor(
        self, *, speed_rpm: float, speed_rad_s: None = None, pump: Pump | None = None
    ) -> float: ...
    @overload
    def displacement_factor(
        self, *, speed_rpm: None = None, speed_rad_s: float, pump: Pump | None = None
    ) -> float: ...
    @overload
    def displacement_factor(
        self, *, speed_rpm: _Numbers, speed_rad_s: None = None, pump: Pump | None = None
    ) -> _Array: ...
    @overload
    def displacement_factor(
        self, *, speed_rpm: None = None, speed_rad_s: _Numbers, pump: Pump | None = None
    ) -> _Array: ...
    @overload
    def standard_uncertainty(
        self, *, speed_rpm: float, speed_rad_s: None = None, pump: Pump | None = None
    ) -> float: ...
    @overload
    def standard_uncertainty(
        self, *, speed_rpm: None = None, speed_rad_s: float, pump: Pump | None = None
    ) -> float: ...
    @overload
    def standard_uncertainty(
        self, *, speed_rpm: _Numbers, speed_rad_s: None = None, pump: Pump | None = None
    ) -> _Array: ...
    @overload
    def standard_uncertainty(
        self, *, speed_rpm: None = None, speed_rad_s: _Numbers, pump: Pump | None = None
    ) -> _Array: ...
    @property
    def version(self) -> int: ...
    @property
    def date(self) -> str: ...
    @property
    def fluid(self) -> str: ...
    @property
    def temperature_degc(self) -> float: ...
    @property
    def tube(self) -> str | None: ...
    @property
    def note(self) -> str | None: ...
    @property
    def revolution_ml(self) -> float: ...
    @property
    def speeds_rpm(self) -> list[float]: ...
    @property
    def scatter(self) -> float | None: ...
    @property
    def outliers(self) -> list[int]: ...
    @property
    def zero_rad(self) -> float: ...
    @property
    def roller_volume_ml(self) -> tuple[float, float] | None: ...
    @property
    def engagement_rad(self) -> tuple[float, float] | None: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...

@final
class Doser:
    def __new__(
        cls, pump: Pump, limits: Limits | None = None, calibration: Calibration | None = None
    ) -> Doser: ...
    @property
    def pump(self) -> Pump: ...
    @property
    def limits(self) -> Limits: ...
    @property
    def calibration(self) -> Calibration | None: ...
    @overload
    def plan(
        self,
        volume: str,
        *,
        rate: str | None = None,
        speed: None = None,
        within: None = None,
        smooth: bool = False,
        finish: Finish = "any",
        ramps: Ramps = "line",
        retract: str | None = None,
        start_angle_rad: float = 0.0,
        start_half_width_rad: float = 0.0,
        carry_in_ml: float = 0.0,
    ) -> Plan: ...
    @overload
    def plan(
        self,
        volume: str,
        *,
        rate: None = None,
        speed: str,
        within: None = None,
        smooth: bool = False,
        finish: Finish = "any",
        ramps: Ramps = "line",
        retract: str | None = None,
        start_angle_rad: float = 0.0,
        start_half_width_rad: float = 0.0,
        carry_in_ml: float = 0.0,
    ) -> Plan: ...
    @overload
    def plan(
        self,
        volume: str,
        *,
        rate: None = None,
        speed: None = None,
        within: str,
        smooth: bool = False,
        finish: Finish = "any",
        ramps: Ramps = "line",
        retract: str | None = None,
        start_angle_rad: float = 0.0,
        start_half_width_rad: float = 0.0,
        carry_in_ml: float = 0.0,
    ) -> Plan: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
