from collections.abc import Callable, Sequence
from os import PathLike
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pandas import Series

from pumpmodel.choices import Begin, LineParameter, Port, VolumeMethod

from .pump import Line, Pump

# A number of Python or NumPy.
_Number: TypeAlias = float | np.floating[Any] | np.integer[Any]
_Array: TypeAlias = NDArray[np.float64]
# Arguments that become an array; a single number stays a number.
_Numbers: TypeAlias = NDArray[np.floating[Any] | np.integer[Any]] | Sequence[Any] | Series[Any]
_Fluid: TypeAlias = tuple[float, float, float, float | None]
_Hose: TypeAlias = tuple[float, float, float, float, float, float]
_Law: TypeAlias = tuple[float, float, float, float]
_Points: TypeAlias = Sequence[tuple[float, float]]
# JSON and text, the line, then the varied, the measured and the fitted numbers, the covariances, and the keys of
# the parameters in the order of the covariances.
_Identified: TypeAlias = tuple[str, str, Line, list[_Array], _Array, list[str]]
# Name, value, standard uncertainty, and whether the parameter was held.
_Told: TypeAlias = tuple[str, float, float, bool]
# Parameters of the line, the recordings, the covariances, the warnings and the line.
_Jointly: TypeAlias = tuple[
    list[_Told], list[tuple[list[_Told], int, float, list[_Array]]], _Array, list[str], Line
]
_Falls: TypeAlias = list[tuple[float, float, float]]

def _cavitation(kpa: float, place: str) -> str:
    """Returns the warning of a pressure below 0 at a place."""

def _number(name: str, argument: object, unit: str | None = None) -> float:
    """Returns the float of an argument. `unit` is that of a name that does not end with it."""

def _numbers(name: str, argument: object) -> float | _Array:
    """Returns the numbers that NumPy makes of an argument: a float, or an array of float64 of its shape."""

def _choices() -> list[tuple[str, list[str]]]:
    """Returns the name of each type of `pumpmodel.choices`, with the words that the library takes or gives."""

def _fluid_check(fluid: _Fluid) -> None:
    """Refuses properties that no fluid has."""

def _fluid_water(temperature_degc: _Number) -> _Fluid:
    """Returns the properties of water at a temperature, degC."""

def _heads(words: list[str]) -> str:
    """Returns the heads that match all words, as JSON."""

def _hose_volume(hose: _Hose) -> float:
    """Returns the volume of a hose's bore, mL. Refuses dimensions that no hose has."""

def _hose_line(hose: _Hose, fluid: _Fluid, reservoir_kpa: _Number, flow_ml_s: _Number) -> Line:
    """Returns the linear line of a hose."""

def _hose_drop(hose: _Hose, fluid: _Fluid, flow_ml_s: _Number | _Numbers) -> float | _Array:
    """Returns the pressure drop at a flow, kPa."""

def _hose_reynolds(hose: _Hose, fluid: _Fluid, flow_ml_s: _Number | _Numbers) -> float | _Array:
    """Returns the Reynolds number of a flow."""

def _identify_resistance(
    pump: Pump,
    port: Port,
    flow_ml_s: ArrayLike,
    pressure_kpa: ArrayLike | None,
    drop_kpa: ArrayLike | None,
    standard_kpa: ArrayLike | None,
    offset: bool,
) -> _Identified:
    """Finds R from steady flows, and from absolute pressures at the pump or drops along the flow."""

def _identify_compliance(
    pump: Pump, port: Port, volume_ml: ArrayLike, pressure_kpa: ArrayLike, total_ml: _Number | None
) -> _Identified:
    """Finds C from injected volumes and pressures."""

def _identify_line(
    pump: Pump,
    port: Port,
    time_s: ArrayLike,
    pressure_kpa: ArrayLike,
    speed_rpm: _Number | None,
    speed_rad: _Number | None,
    fit: Sequence[LineParameter],
    begin: Begin,
    start_s: _Number | None,
    start_angle_rad: _Number | None,
) -> _Identified:
    """Finds R, C and L from a waveform."""

def _identify_line_jointly(
    pump: Pump,
    port: Port,
    recordings: Sequence[tuple[Any, ...]],
    fit: Sequence[LineParameter],
) -> _Jointly:
    """Finds R, C and L from several waveforms."""

def rmse(model: ArrayLike, measured: ArrayLike) -> float:
    """Return the root of the mean square of model less measured.

    Parameters
    ----------
    model, measured : array_like
        Numbers of one shape, in one unit.

    Returns
    -------
    float
        RMSE, in the unit of the numbers.

    Raises
    ------
    ValueError
        If the shapes differ, a number is not finite, or the arrays are empty.

    Examples
    --------
    >>> import pumpmodel as pm
    >>> pm.rmse([1.0, 4.0], [2.0, 3.0])
    1.0
    """

def nrmse(model: ArrayLike, measured: ArrayLike) -> float:
    """Return the RMSE over the absolute mean of the measurement, as McIntyre et al. report it.

    Parameters
    ----------
    model, measured : array_like
        Numbers of one shape, in one unit.

    Returns
    -------
    float
        Fraction: 0.02 is 2 %. The mean of absolute pressures is mostly ambient.

    Raises
    ------
    ValueError
        If the shapes differ, a number is not finite, or the mean of the measurement is 0.

    Examples
    --------
    >>> import pumpmodel as pm
    >>> pm.nrmse([210.0, 190.0], [200.0, 200.0])
    0.05
    """

def pearson(model: ArrayLike, measured: ArrayLike) -> float:
    """Return Pearson's correlation of model and measured.

    Parameters
    ----------
    model, measured : array_like
        Numbers of one shape.

    Returns
    -------
    float
        Correlation, -1 to 1: it compares rises and falls, not sizes.

    Raises
    ------
    ValueError
        If the shapes differ, a number is not finite, or one of them does not change.

    Examples
    --------
    >>> import pumpmodel as pm
    >>> round(pm.pearson([1.0, 2.0, 3.0], [10.0, 12.0, 14.0]), 12)
    1.0
    """

def _law_published() -> _Law:
    """Returns the law fitted to the numbers that McIntyre et al. publish."""

def _law_check(law: _Law) -> None:
    """Refuses parameters that no speed law has."""

def _law_revolution(
    law: _Law, pump: Pump, speed_rpm: _Number | _Numbers | None, speed_rad_s: _Number | _Numbers | None
) -> float | _Array:
    """Returns the volume of a revolution at a speed, mL."""

def _law_trapped(
    law: _Law, pump: Pump, speed_rpm: _Number | _Numbers | None, speed_rad_s: _Number | _Numbers | None
) -> float | _Array:
    """Returns the pressure at which a segment of tube is trapped at a speed, kPa absolute."""

def _volume_fit(
    method: str, points: _Points
) -> tuple[float, float, list[float], float, _Falls | None, list[tuple[float, float]]]:
    """Fits points, and reports the residuals of the fit."""

def _volume_fit_at(method: VolumeMethod, points: _Points, angle_rad: _Number | _Numbers) -> float | _Array:
    """Returns the volume displaced at an angle since first contact, mL."""

def _volume_polynomial(
    highest_first: tuple[float, ...], engagement_deg: float
) -> tuple[float, list[tuple[float, float]]]:
    """Returns V_r (mL) of a polynomial, and the stretches over which its volume is held (deg)."""

def _volume_polynomial_at(
    highest_first: tuple[float, ...], engagement_deg: float, angle_rad: _Number | _Numbers
) -> float | _Array:
    """Returns the volume that a polynomial has displaced at an angle since first contact, mL."""

def _volume_runs(path: str | PathLike[str]) -> list[tuple[str, float, float]]:
    """Returns run, angle (deg) and volume (mL) of each row of a table that `dose pumps new` reads."""

def _volume_run_falls(runs: Sequence[str], points: _Points) -> list[tuple[str, float, float, float]]:
    """Returns each fall within a run: its run, from and to angle (deg), and by how much the volume falls (mL)."""

def _reading(reading: str) -> tuple[float | None, float | None]:
    """Reads the reading of a scale, g, or of a vessel, mL."""

def _steady_states(
    pumps: Sequence[Pump],
    *,
    speed_rpm: _Numbers | None = None,
    speed_rad_s: _Numbers | None = None,
    threads: int | None = None,
    first: int = 0,
    progress: Callable[[int, int], object] | None = None,
) -> list[_Array]:
    """\
    Computes the steady state of every pump at every speed: an array of shape (pumps, speeds) for each attribute of a
    `SteadyState` but the speed, in their order.

    `first` is the number of the first pump in errors. `progress(done, total)` is called now and then and at the end.
    """
