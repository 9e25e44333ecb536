from collections.abc import Callable, Sequence
from os import PathLike
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pumpmodel.choices import Begin, LineParameter, Port, VolumeMethod

from .pump import Line, Pump

_Array: TypeAlias = NDArray[np.float64]
# Arguments that become an array; a single number stays a number.
_Numbers: TypeAlias = NDArray[np.floating[Any] | np.integer[Any]] | Sequence[Any]
_Fluid: TypeAlias = tuple[float, float, float, float | None]
_Hose: TypeAlias = tuple[float, float, float, float, float, float]
_Law: TypeAlias = tuple[float, float, float, float]
_Points: TypeAlias = Sequence[tuple[float, float]]
# JSON and text, the line, then the varied, the measured and the fitted numbers.
_Identified: TypeAlias = tuple[str, str, Line, _Array, _Array, _Array]
_Falls: TypeAlias = list[tuple[float, float, float]]

def _choices() -> list[tuple[str, list[str]]]: ...
def _fluid_check(fluid: _Fluid) -> None: ...
def _fluid_water(temperature_degc: float) -> _Fluid: ...
def _heads(words: list[str]) -> str: ...
def _hose_volume(hose: _Hose) -> float: ...
def _hose_line(hose: _Hose, fluid: _Fluid, reservoir_kpa: float, flow_ml_s: float) -> Line: ...
def _hose_drop(hose: _Hose, fluid: _Fluid, flow_ml_s: float | _Numbers) -> float | _Array: ...
def _hose_reynolds(hose: _Hose, fluid: _Fluid, flow_ml_s: float | _Numbers) -> float | _Array: ...
def _identify_resistance(
    pump: Pump,
    port: Port,
    flow_ml_s: ArrayLike,
    pressure_kpa: ArrayLike | None,
    drop_kpa: ArrayLike | None,
    standard_kpa: ArrayLike | None,
    offset: bool,
) -> _Identified: ...
def _identify_compliance(
    pump: Pump, port: Port, volume_ml: ArrayLike, pressure_kpa: ArrayLike, total_ml: float | None
) -> _Identified: ...
def _identify_line(
    pump: Pump,
    port: Port,
    time_s: ArrayLike,
    pressure_kpa: ArrayLike,
    speed_rpm: float | None,
    speed_rad: float | None,
    fit: Sequence[LineParameter],
    begin: Begin,
    start_s: float | None,
    start_angle_rad: float | None,
) -> _Identified: ...
def rmse(model: ArrayLike, measured: ArrayLike) -> float: ...
def nrmse(model: ArrayLike, measured: ArrayLike) -> float: ...
def pearson(model: ArrayLike, measured: ArrayLike) -> float: ...
def _law_published() -> _Law: ...
def _law_check(law: _Law) -> None: ...
def _law_revolution(
    law: _Law, pump: Pump, speed_rpm: float | _Numbers | None, speed_rad_s: float | _Numbers | None
) -> float | _Array: ...
def _law_trapped(
    law: _Law, pump: Pump, speed_rpm: float | _Numbers | None, speed_rad_s: float | _Numbers | None
) -> float | _Array: ...
def _volume_fit(
    method: str, points: _Points
) -> tuple[float, float, list[float], float, _Falls | None, list[tuple[float, float]]]: ...
def _volume_fit_at(method: VolumeMethod, points: _Points, angle_rad: float | _Numbers) -> float | _Array: ...
def _volume_runs(path: str | PathLike[str]) -> list[tuple[str, float, float]]: ...
def _volume_run_falls(runs: Sequence[str], points: _Points) -> list[tuple[str, float, float, float]]: ...
def _reading(reading: str) -> tuple[float | None, float | None]: ...
def _steady_states(
    pumps: Sequence[Pump],
    *,
    speed_rpm: _Numbers | None = None,
    speed_rad_s: _Numbers | None = None,
    threads: int | None = None,
    first: int = 0,
    progress: Callable[[int, int], object] | None = None,
) -> list[_Array]: ...
