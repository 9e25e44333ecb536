"""Lines identified from measurements."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pumpmodel import _pumpmodel as core
from pumpmodel._pumpmodel import Line, Pump
from pumpmodel._results.numbers import Number
from pumpmodel._results.record import Record
from pumpmodel._results.renamed import renamed
from pumpmodel.choices import Begin, Identification, LineParameter, Port

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_Array: TypeAlias = NDArray[np.float64]

# Name of what was varied in the measurement, for each kind.
_VARIED: dict[Identification, str] = {
    "resistance": "flow_ml_s",
    "compliance": "volume_ml",
    "line": "time_s",
}


@dataclass(frozen=True)
class Estimate(Record):
    """A value with its standard uncertainty; twice the uncertainty covers 95 %.

    `held` is True if the value was given and not sought. The uncertainty is 0 then, and where all points
    agree with the fit exactly, as those of a simulation do.
    """

    value: float
    standard: float
    held: bool


def _estimate(told: dict[str, Any]) -> Estimate:
    # The report has no uncertainty of points that agree exactly.
    return Estimate.from_dict(told | {"standard": told["standard"] or 0.0})


@dataclass(frozen=True, eq=False, repr=False)
class Identified:
    """An identified line, with the parameters, the quality and the warnings of the fit.

    `identify_resistance`, `identify_compliance` and `identify_line` return it. `str(...)` is the report of
    `dose identify`. Parameters and covariances of a line are in the order R, C, L, reservoir, angle, start:
    `covariance_names` has the names of the rows of `covariance`, those of the sought parameters alone.
    """

    #: Kind of identification: "resistance", "compliance" or "line".
    kind: Identification
    #: Port of the line: "inlet" or "outlet".
    port: Port
    #: Line of the pump with the identified parameters: `pump.replace(outlet=found.line)`.
    line: Line
    #: Parameters, sought or held, by name with unit, as "inertance_kpa_s2_ml".
    parameters: dict[str, Estimate]
    #: Warnings; a fit of a wrong model is one.
    warnings: tuple[str, ...]
    #: RMSE of measured less fitted, kPa.
    rmse_kpa: float
    #: RMSE over the mean of the measurement; None if the mean is 0.
    nrmse: float | None
    #: Pearson's correlation of fitted and measured; None if either does not change.
    pearson: float | None
    #: Number of independent points to which the measurements amount.
    independent_points: float
    #: Number of points that were given. The fit uses fewer of a long recording.
    rows: int
    #: Measured values, kPa, shape (n,), read-only: drops for a resistance, otherwise pressures.
    measured_kpa: _Array
    #: Fitted values, kPa, shape (n,), read-only.
    fitted_kpa: _Array
    #: Names of the rows of `covariance`: the sought parameters in the order of `parameters`.
    covariance_names: tuple[str, ...]
    #: Covariances of the sought parameters in their units, shape (k, k), read-only. The roots of the diagonal
    #: are their `standard`.
    covariance: _Array
    # Times, flows or volumes, by the kind.
    _varied: _Array
    # JSON and text of the command.
    _json: str = field(default="")
    _text: str = field(default="")

    @classmethod
    def _of(cls, answer: tuple[str, str, Line, list[_Array], _Array, Sequence[str]]) -> Identified:
        told, text, line, (varied, measured, fitted), covariance, names = answer
        data = json.loads(told)
        parameters = {name: _estimate(data["parameters"][name]) for name in names}
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
            rows=data["rows"],
            measured_kpa=measured,
            fitted_kpa=fitted,
            covariance_names=tuple(name for name, found in parameters.items() if not found.held),
            covariance=covariance,
            _varied=varied,
            _json=told,
            _text=text,
        )

    @property
    def time_s(self) -> _Array:
        """Times of the values, s, rising, shape (n,), read-only. Only a line has them."""
        return self._varied_by("line", "time_s")

    @property
    def flow_ml_s(self) -> _Array:
        """Flows of the values, mL/s, rising, shape (n,), read-only. Only a resistance has them."""
        return self._varied_by("resistance", "flow_ml_s")

    @property
    def volume_ml(self) -> _Array:
        """Injected volumes of the values, mL, rising, shape (n,), read-only. Only a compliance has them."""
        return self._varied_by("compliance", "volume_ml")

    @property
    def x(self) -> _Array:
        """Deprecated name of `time_s`, `flow_ml_s` and `volume_ml`."""
        renamed("Identified.x", f"Identified.{_VARIED[self.kind]}")
        return self._varied

    @property
    def residual_kpa(self) -> _Array:
        """Residuals, measured less fitted, kPa, shape (n,)."""
        return self.measured_kpa - self.fitted_kpa

    @property
    def log_likelihood(self) -> float:
        """Natural logarithm of the likelihood of the fit, if the residuals are white noise.

        It is the largest over the noise: -n/2 (ln(2 pi rmse²) + 1) for the n values of `residual_kpa`. It is
        infinite where the fit meets every value. Differences compare models of the same measurement.
        """
        if self.rmse_kpa == 0:
            return math.inf
        return -0.5 * len(self.measured_kpa) * (math.log(math.tau * self.rmse_kpa**2) + 1)

    def to_dict(self) -> dict[str, Any]:
        """Return the fit as plain data.

        Returns
        -------
        dict
            The command's JSON `identification/1`, without the measurements. Its `pump_file` is the table for
            a pump file.
        """
        data: dict[str, Any] = json.loads(self._json)
        return data

    def plot(self, *, ax: Axes | Sequence[Axes] | None = None) -> list[Axes]:
        """Draw measurement and fit, and the residuals below them.

        `ax` takes axes for both, or for the fit alone. The default is a new figure. Needs matplotlib.
        """
        from pumpmodel.plotting.fits import plot_identified

        return plot_identified(self, ax=ax)

    def _repr_html_(self) -> str:
        from pumpmodel._results.notebook.shown import identified_html

        return identified_html(self)

    def __str__(self) -> str:
        """Return the report of the command."""
        return self._text

    def __repr__(self) -> str:
        """Return kind, port and the parameters that were found."""
        found = ", ".join(
            f"{name}={estimate.value:.6g} ± {2 * estimate.standard:.2g}"
            for name, estimate in self.parameters.items()
            if not estimate.held
        )
        return f"Identified({self.kind}, {self.port}: {found}; {len(self.warnings)} warnings)"

    def __eq__(self, other: object) -> bool:
        """Tell if values, warnings, metrics and measurements are equal."""
        if not isinstance(other, Identified):
            return NotImplemented
        return (self._json, self.line) == (other._json, other.line) and all(
            np.array_equal(mine, theirs) for mine, theirs in zip(self._arrays(), other._arrays(), strict=True)
        )

    def __hash__(self) -> int:
        """Hash the values that are compared, except for the measurements."""
        return hash((self._json, self.line))

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle the arrays so that they are read-only again when they are loaded."""
        return _rebuild, (self._json, self._text, self.line, *self._arrays(), tuple(self.parameters))

    def _arrays(self) -> tuple[_Array, _Array, _Array, _Array]:
        return self._varied, self.measured_kpa, self.fitted_kpa, self.covariance

    def _varied_by(self, kind: Identification, name: str) -> _Array:
        if self.kind != kind:
            raise AttributeError(f"an identified {self.kind} has no {name}; it has {_VARIED[self.kind]}")
        return self._varied


def _rebuild(told: str, text: str, line: Line, *parts: Any) -> Identified:
    # Fits that were pickled before have the order of the JSON, which has no names beside it.
    names = parts[4] if len(parts) > 4 else tuple(json.loads(told)["parameters"])
    *columns, covariance = parts[:4]
    for array in parts[:4]:
        array.setflags(write=False)
    return Identified._of((told, text, line, columns, covariance, names))


def _pump(pump: Pump | None) -> Pump:
    return Pump.three_roller() if pump is None else pump


def identify_resistance(
    flow_ml_s: ArrayLike,
    pressure_kpa: ArrayLike | None = None,
    *,
    drop_kpa: ArrayLike | None = None,
    pump: Pump | None = None,
    port: Port = "outlet",
    standard_kpa: ArrayLike | None = None,
    offset: bool = False,
) -> Identified:
    """Find R of a line from steady flows and their pressure drops: dP = R Q (McIntyre et al.).

    Parameters
    ----------
    flow_ml_s : array_like
        Flows, mL/s, negative in reverse, shape (n,).
    pressure_kpa : array_like, optional
        Pressures at the pump, kPa absolute, shape (n,). The drop is the difference from the reservoir of the
        pump's line.
    drop_kpa : array_like, optional
        Pressure drops along the flow, kPa, shape (n,). Give exactly one of `pressure_kpa` and `drop_kpa`.
    pump : Pump, optional
        Pump of the line, which gives reservoir, C and L. By default the built-in pump with three rollers.
    port : {"outlet", "inlet"}
        Port whose line is identified.
    standard_kpa : array_like, optional
        Standard uncertainties of the pressures, kPa, shape (n,). Their ratios weight the points.
    offset : bool
        True to seek the drop at no flow too, which shows an error of reservoir or sensor.

    Returns
    -------
    Identified
        Line with `resistance_kpa_s_ml`, and `offset_kpa` if it was sought.

    Raises
    ------
    ValueError
        If the points are too few or do not determine R, for example because every flow has the same drop.

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
    port: Port = "outlet",
    total_ml: Number | None = None,
) -> Identified:
    """Find C of a closed line from a syringe that injects into it: C = dV/dP.

    Parameters
    ----------
    volume_ml : array_like
        Volumes injected since the start, mL, shape (n,).
    pressure_kpa : array_like
        Pressures in the line, kPa, absolute or above any constant pressure, shape (n,).
    pump : Pump, optional
        Pump of the line, which gives reservoir, R and L. By default the built-in pump with three rollers.
    port : {"outlet", "inlet"}
        Port whose line is identified.
    total_ml : float, optional
        Volume of the closed line, mL, from which the effective bulk modulus follows too.

    Returns
    -------
    Identified
        Line with `compliance_ml_kpa` and `start_kpa`, and with `bulk_modulus_kpa` if `total_ml` is given.

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
    port: Port = "outlet",
    speed_rpm: Number | None = None,
    speed_rad_s: Number | None = None,
    fit: Sequence[LineParameter] = ("R", "C", "L"),
    begin: Begin = "ramp",
    start_s: Number | None = None,
    start_angle_rad: Number | None = None,
) -> Identified:
    """Find R, C and L of a line from the pressure over time while the pump turns.

    Least squares on the model, from several starts.

    Parameters
    ----------
    pump : Pump
        Pump of the line. Its flow counts as known, and the search starts from its line.
    time_s : array_like
        Times, s, rising, shape (n,).
    pressure_kpa : array_like
        Pressures at the port, kPa absolute, shape (n,).
    port : {"outlet", "inlet"}
        Port whose line is identified.
    speed_rpm : float
        Speed of the pump head, r/min; negative in reverse.
    speed_rad_s : float
        Speed of the pump head, rad/s. Give exactly one of `speed_rpm` and `speed_rad_s`.
    fit : sequence of {"R", "C", "L", "reservoir", "start"}
        Parameters to seek; all others are held. "reservoir" is the pressure of the reservoir, which absorbs
        an offset of the sensor. "start" is the time of the start, which is found only near `start_s`.
    begin : {"ramp", "step", "steady"}
        Motion at the start of the record: from rest with the pump's acceleration, from rest at full speed, or
        turning long before.
    start_s : float, optional
        Time at which the pump began to turn, s; by default 0.
    start_angle_rad : float, optional
        Angle at the start, or at time 0 of a steady record, rad. By default it is sought.

    Returns
    -------
    Identified
        Line with R, C, L, `reservoir_kpa`, `start_angle_deg` and `start_s`, sought or held. The standard
        uncertainties do not include a mismatch of the model: read `warnings`.

    Raises
    ------
    ValueError
        If an argument is not allowed, if the record does not determine the parameters, or if the search does
        not end.

    Examples
    --------
    >>> import pumpmodel as pm
    >>> pump = pm.Pump.three_roller()
    >>> run = pump.replace(outlet=pump.outlet.replace(inertance_kpa_s2_ml=0.006)).simulate(
    ...     speed_rpm=100, duration_s=0.5, dt_s=2e-3
    ... )
    >>> found = pm.identify_line(
    ...     pump, time_s=run.time_s, pressure_kpa=run.outlet_kpa, speed_rpm=100, begin="step"
    ... )
    >>> round(found.line.inertance_kpa_s2_ml, 6)
    0.006
    """
    if isinstance(fit, str):
        raise TypeError(f'fit is a text, {fit!r}; allowed: a sequence of names, as ("R", "C", "L")')
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
