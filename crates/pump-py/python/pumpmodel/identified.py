"""Lines identified from measurements."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pumpmodel import _pumpmodel as core
from pumpmodel._pumpmodel import Line, Pump
from pumpmodel._record import Record

_Array: TypeAlias = NDArray[np.float64]
_Port: TypeAlias = Literal["inlet", "outlet"]


@dataclass(frozen=True)
class Estimate(Record):
    """A value with its standard uncertainty, twice which covers 95 %.

    `held` says that it was given and not sought.
    """

    value: float
    standard: float
    held: bool


@dataclass(frozen=True, eq=False, repr=False)
class Identified:
    """A line that was identified, and what is to be said of the fit.

    Made by `identify_resistance`, `identify_compliance` and `identify_line`. `str(...)` is the report of
    `dose identify`.
    """

    #: "resistance", "compliance" or "line".
    kind: str
    #: "inlet" or "outlet".
    port: str
    #: The line of the pump with what was found in it: `pump.replace(outlet=found.line)`.
    line: Line
    #: What was found and what was held, by name with unit, as "inertance_kpa_s2_ml".
    parameters: dict[str, Estimate]
    #: What the user should know; a fit to a wrong model is warned of here.
    warnings: tuple[str, ...]
    #: Root of the mean square of measured less fitted, kPa.
    rmse_kpa: float
    #: RMSE over the mean of what was measured; None if that is 0.
    nrmse: float | None
    #: Pearson's correlation of fitted and measured; None if either does not change.
    pearson: float | None
    #: How many independent points the measurements are worth.
    independent_points: float
    #: Times in s, flows in mL/s or volumes in mL, rising, shape (n,), read-only.
    x: _Array
    #: What was measured there, kPa: drops of a resistance, pressures else.
    measured_kpa: _Array
    #: What the fit says there, kPa.
    fitted_kpa: _Array
    # JSON and text of the command.
    _json: str = field(default="")
    _text: str = field(default="")

    @classmethod
    def _of(cls, answer: tuple[str, str, Line, _Array, _Array, _Array]) -> Identified:
        told, text, line, x, measured, fitted = answer
        data = json.loads(told)
        parameters = {name: Estimate.from_dict(found) for name, found in data["parameters"].items()}
        return cls(
            kind=data["kind"],
            port=data["line"],
            line=line,
            parameters=parameters,
            warnings=tuple(data["warnings"]),
            rmse_kpa=data["rmse_kpa"],
            nrmse=data["nrmse"],
            pearson=data["pearson"],
            independent_points=data["independent_points"],
            x=x,
            measured_kpa=measured,
            fitted_kpa=fitted,
            _json=told,
            _text=text,
        )

    @property
    def residual_kpa(self) -> _Array:
        """Measured less fitted, kPa, shape (n,)."""
        return self.measured_kpa - self.fitted_kpa

    def to_dict(self) -> dict[str, Any]:
        """Return the fit as plain data.

        Returns
        -------
        dict
            The command's JSON `identification/1`, whose `pump_file` is the table for a pump file; without the
            measurements.
        """
        data: dict[str, Any] = json.loads(self._json)
        return data

    def __str__(self) -> str:
        """Return the report of the command."""
        return self._text

    def __repr__(self) -> str:
        """Return kind, port and what was found."""
        found = ", ".join(
            f"{name}={estimate.value:.6g} ± {2 * estimate.standard:.2g}"
            for name, estimate in self.parameters.items()
            if not estimate.held
        )
        return f"Identified({self.kind}, {self.port}: {found}; {len(self.warnings)} warnings)"

    def __eq__(self, other: object) -> bool:
        """Whether values, warnings, metrics and measurements are the same."""
        if not isinstance(other, Identified):
            return NotImplemented
        return (self._json, self.line) == (other._json, other.line) and all(
            np.array_equal(mine, theirs) for mine, theirs in zip(self._arrays(), other._arrays(), strict=True)
        )

    def __hash__(self) -> int:
        """Hash what is compared, but for the measurements."""
        return hash((self._json, self.line))

    def __reduce__(self) -> tuple[Any, ...]:
        """Rebuild with arrays that are read-only again."""
        return _rebuild, (self._json, self._text, self.line, *self._arrays())

    def _arrays(self) -> tuple[_Array, _Array, _Array]:
        return self.x, self.measured_kpa, self.fitted_kpa


def _rebuild(told: str, text: str, line: Line, *arrays: _Array) -> Identified:
    x, measured, fitted = arrays
    for array in arrays:
        array.setflags(write=False)
    return Identified._of((told, text, line, x, measured, fitted))


def _pump(pump: Pump | None) -> Pump:
    return Pump.three_roller() if pump is None else pump


def identify_resistance(
    flow_ml_s: ArrayLike,
    pressure_kpa: ArrayLike | None = None,
    *,
    drop_kpa: ArrayLike | None = None,
    pump: Pump | None = None,
    port: _Port = "outlet",
    standard_kpa: ArrayLike | None = None,
    offset: bool = False,
) -> Identified:
    """Find R of a line from steady flows and the pressures that they take: dP = R Q (McIntyre et al.).

    Parameters
    ----------
    flow_ml_s : array_like
        Flows, mL/s, negative in reverse, shape (n,).
    pressure_kpa : array_like, optional
        Pressures at the pump, kPa absolute, shape (n,); less the reservoir of the pump's line they are the
        drops.
    drop_kpa : array_like, optional
        In their place drops along the flow, kPa, shape (n,).
    pump : Pump, optional
        Whose line it is: gives reservoir, C and L. By default the built-in pump with three rollers.
    port : {"outlet", "inlet"}
        Which of its lines.
    standard_kpa : array_like, optional
        Standard uncertainties of the pressures, kPa, shape (n,); the points weigh by their ratios.
    offset : bool
        Whether to seek the drop at no flow too: a reservoir or a sensor that is off.

    Returns
    -------
    Identified
        With `resistance_kpa_s_ml`, and `offset_kpa` if it was sought.

    Raises
    ------
    ValueError
        If the points are too few or do not determine R, as when the drop is as large at every flow.

    Examples
    --------
    >>> import pumpmodel as pm
    >>> found = pm.identify_resistance([10, 20, 40, 60], drop_kpa=[1.11, 2.21, 4.44, 6.64])
    >>> round(found.line.resistance_kpa_s_ml, 4)
    0.1108
    """
    return Identified._of(
        core._identify_resistance(_pump(pump), port, flow_ml_s, pressure_kpa, drop_kpa, standard_kpa, offset)
    )


def identify_compliance(
    volume_ml: ArrayLike,
    pressure_kpa: ArrayLike,
    *,
    pump: Pump | None = None,
    port: _Port = "outlet",
    total_ml: float | None = None,
) -> Identified:
    """Find C of a closed line from a syringe that injects into it: C = dV/dP.

    Parameters
    ----------
    volume_ml : array_like
        Volumes injected since the start, mL, shape (n,).
    pressure_kpa : array_like
        Pressures in the line, kPa, absolute or above anything that stays the same, shape (n,).
    pump : Pump, optional
        Whose line it is: gives reservoir, R and L. By default the built-in pump with three rollers.
    port : {"outlet", "inlet"}
        Which of its lines.
    total_ml : float, optional
        Volume that the closed line holds, mL: gives the effective bulk modulus too.

    Returns
    -------
    Identified
        With `compliance_ml_kpa`, `start_kpa`, and `bulk_modulus_kpa` of a `total_ml`.

    Raises
    ------
    ValueError
        If the points are too few or do not determine C.

    Examples
    --------
    >>> import pumpmodel as pm
    >>> found = pm.identify_compliance([0, 0.1, 0.2, 0.3, 0.4], [88.6, 91.4, 94.2, 96.9, 99.7])
    >>> round(found.line.compliance_ml_kpa, 4)
    0.0361
    """
    return Identified._of(core._identify_compliance(_pump(pump), port, volume_ml, pressure_kpa, total_ml))


def identify_line(
    pump: Pump,
    *,
    time_s: ArrayLike,
    pressure_kpa: ArrayLike,
    port: _Port = "outlet",
    speed_rpm: float | None = None,
    speed_rad_s: float | None = None,
    fit: Sequence[Literal["R", "C", "L", "reservoir", "start"]] = ("R", "C", "L"),
    begin: Literal["ramp", "step", "steady"] = "ramp",
    start_s: float | None = None,
    start_angle_rad: float | None = None,
) -> Identified:
    """Find R, C and L of a line from the pressure over time while the pump turns.

    Least squares on the model, from several starts.

    Parameters
    ----------
    pump : Pump
        Whose line it is; its flow is taken as known, and the search starts from its line.
    time_s : array_like
        Times, s, rising, shape (n,).
    pressure_kpa : array_like
        Pressures at the port, kPa absolute, shape (n,).
    port : {"outlet", "inlet"}
        Which line.
    speed_rpm, speed_rad_s : float
        Speed of the pump head, exactly one; negative in reverse.
    fit : sequence of {"R", "C", "L", "reservoir", "start"}
        What is sought; the rest is held. "reservoir" is its pressure, and with it what the sensor is off by,
        "start" the time of the start, found only near `start_s`.
    begin : {"ramp", "step", "steady"}
        From rest with the pump's acceleration, from rest at once, or turning for long.
    start_s : float, optional
        When it began to turn, s; by default 0.
    start_angle_rad : float, optional
        Angle at the start, rad (steady: at time 0). By default it is sought.

    Returns
    -------
    Identified
        With R, C, L, `reservoir_kpa`, `start_angle_deg` and `start_s`, sought or held. A mismatch of the
        model is not in the standard uncertainties: read `warnings`.

    Raises
    ------
    ValueError
        If an argument is not allowed, the record does not determine what is sought, or the search does not
        end.

    Examples
    --------
    >>> import pumpmodel as pm
    >>> pump = pm.Pump.three_roller()
    >>> run = pump.replace(outlet=pump.outlet.replace(inertance_kpa_s2_ml=0.006)).simulate(
    ...     speed_rpm=100, duration_s=0.5, dt_s=2e-3
    ... )
    >>> found = pm.identify_line(
    ...     pump, time_s=run.time_s, pressure_kpa=run.p_out_kpa, speed_rpm=100, begin="step"
    ... )
    >>> round(found.line.inertance_kpa_s2_ml, 6)
    0.006
    """
    if isinstance(fit, str):
        raise TypeError(f'fit is a text, {fit!r}; give a sequence of names, as ("R", "C", "L")')
    return Identified._of(
        core._identify_line(
            pump,
            port,
            time_s,
            pressure_kpa,
            speed_rpm,
            speed_rad_s,
            list(fit),
            begin,
            start_s,
            start_angle_rad,
        )
    )
