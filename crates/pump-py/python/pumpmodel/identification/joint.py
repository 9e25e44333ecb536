"""One line from several recordings."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pumpmodel import _pumpmodel as core
from pumpmodel._pumpmodel import Line, Pump
from pumpmodel._results import checks
from pumpmodel._results.numbers import Number
from pumpmodel.choices import Begin, LineParameter, Port
from pumpmodel.identification.identified import Estimate

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_Array: TypeAlias = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class PressureRecord:
    """A pressure over time while the pump turns: one of the recordings of `identify_line_jointly`."""

    #: Times, s, rising, shape (n,), at any intervals.
    time_s: ArrayLike = field(repr=False)
    #: Pressures at the port, kPa absolute, shape (n,).
    pressure_kpa: ArrayLike = field(repr=False)
    #: Speed of the pump head, r/min; negative in reverse.
    speed_rpm: Number | None = None
    #: Speed of the pump head, rad/s. Give exactly one of `speed_rpm` and `speed_rad_s`.
    speed_rad_s: Number | None = None
    #: Motion at the start: "ramp", from rest with the pump's acceleration; "step", from rest at full speed;
    #: "steady", turning long before.
    begin: Begin = "ramp"
    #: Time at which the pump began to turn, s; None for 0.
    start_s: Number | None = None
    #: Angle at the start, or at time 0 of a steady record, rad. None seeks it, for this recording alone.
    start_angle_rad: Number | None = None
    #: Standard deviation of the noise of a sample, kPa. The ratios between recordings weight them; without it
    #: every sample weighs the same.
    standard_kpa: Number | None = None

    def __eq__(self, other: object) -> bool:
        """Tell if measurement and motion are equal."""
        if not isinstance(other, PressureRecord):
            return NotImplemented
        return self._given()[2:] == other._given()[2:] and all(
            np.array_equal(np.asarray(mine), np.asarray(theirs))
            for mine, theirs in zip(self._given()[:2], other._given()[:2], strict=True)
        )

    __hash__ = None  # type: ignore[assignment]

    def _given(self) -> tuple[Any, ...]:
        return (
            self.time_s,
            self.pressure_kpa,
            self.speed_rpm,
            self.speed_rad_s,
            self.begin,
            self.start_s,
            self.start_angle_rad,
            self.standard_kpa,
        )


@dataclass(frozen=True, eq=False)
class RecordingFit:
    """One of the recordings of a `JointlyIdentified`, with its part of the fit."""

    #: `start_angle_deg` and `start_s` of this recording, sought or held.
    parameters: dict[str, Estimate]
    #: Number of samples that were given. The fit uses fewer of a long recording.
    rows: int
    #: Number of independent samples to which the used ones amount.
    independent_points: float
    #: Standard deviation of the noise that was given, kPa, or None.
    standard_kpa: float | None
    #: Times of the samples that the fit uses, s, shape (n,), read-only.
    time_s: _Array = field(repr=False)
    #: Measured pressures, kPa absolute, shape (n,), read-only.
    measured_kpa: _Array = field(repr=False)
    #: Fitted pressures, kPa absolute, shape (n,), read-only.
    fitted_kpa: _Array = field(repr=False)

    @property
    def residual_kpa(self) -> _Array:
        """Residuals, measured less fitted, kPa, shape (n,)."""
        return self.measured_kpa - self.fitted_kpa

    @property
    def rmse_kpa(self) -> float:
        """RMSE of measured less fitted, kPa."""
        return float(np.sqrt(np.mean(self.residual_kpa**2)))


@dataclass(frozen=True, eq=False, repr=False)
class JointlyIdentified:
    """A line that was identified from several recordings at once, by `identify_line_jointly`."""

    #: Port of the line: "inlet" or "outlet".
    port: Port
    #: Line with the identified parameters: `pump.replace(outlet=found.line)`.
    line: Line
    #: R, C, L and the reservoir of all recordings, sought or held, by name with unit.
    parameters: dict[str, Estimate]
    #: Each recording with its own angle and start, in the order in which they were given.
    recordings: tuple[RecordingFit, ...]
    #: Names of the rows of `covariance`: those of the line, then as "recordings[0].start_angle_deg".
    covariance_names: tuple[str, ...]
    #: Covariances of all parameters that were sought, in their units, shape (k, k), read-only. The roots of
    #: the diagonal are their `standard`.
    covariance: _Array
    #: Warnings, each with its recording.
    warnings: tuple[str, ...]
    # Port, answer of the compiled half, and noise of each recording.
    _raw: tuple[Port, Any, tuple[float | None, ...]]

    @classmethod
    def _of(cls, port: Port, answer: Any, standards: tuple[float | None, ...]) -> JointlyIdentified:
        told, recorded, covariance, warnings, line = answer
        recordings = tuple(
            RecordingFit(_estimates(parameters), rows, independent, standard, *arrays)
            for (parameters, rows, independent, arrays), standard in zip(recorded, standards, strict=True)
        )
        parameters = _estimates(told)
        names = [name for name, estimate in parameters.items() if not estimate.held]
        for place, recording in enumerate(recordings):
            names += [
                f"recordings[{place}].{name}"
                for name, estimate in recording.parameters.items()
                if not estimate.held
            ]
        raw = (port, answer, standards)
        return cls(port, line, parameters, recordings, tuple(names), covariance, tuple(warnings), raw)

    @property
    def rmse_kpa(self) -> float:
        """RMSE of measured less fitted over all samples, kPa."""
        return float(np.sqrt(np.mean(np.concatenate([fit.residual_kpa for fit in self.recordings]) ** 2)))

    @property
    def log_likelihood(self) -> float:
        """Natural logarithm of the likelihood of the fit, if the residuals are white noise.

        It is the largest over the noise, whose ratios between the recordings are those of their
        `standard_kpa`. It is infinite where the fit meets every value. Differences compare models of the same
        measurements.
        """
        sizes = [1.0 if fit.standard_kpa is None else fit.standard_kpa for fit in self.recordings]
        counts = [len(fit.time_s) for fit in self.recordings]
        squares = sum(
            float(np.sum((fit.residual_kpa / size) ** 2))
            for fit, size in zip(self.recordings, sizes, strict=True)
        )
        if squares == 0:
            return math.inf
        count = sum(counts)
        scaled = sum(n * math.log(size) for n, size in zip(counts, sizes, strict=True))
        return -0.5 * count * (math.log(math.tau * squares / count) + 1) - scaled

    def to_dict(self) -> dict[str, Any]:
        """Return the fit as plain data, without the measurements.

        Returns
        -------
        dict
            Numbers, texts, lists and dicts only.
        """
        return {
            "port": self.port,
            "line": self.line.to_dict(),
            "parameters": {name: estimate.to_dict() for name, estimate in self.parameters.items()},
            "recordings": [
                {
                    "parameters": {name: estimate.to_dict() for name, estimate in fit.parameters.items()},
                    "rows": fit.rows,
                    "independent_points": fit.independent_points,
                    "standard_kpa": fit.standard_kpa,
                    "rmse_kpa": fit.rmse_kpa,
                }
                for fit in self.recordings
            ],
            "covariance_names": list(self.covariance_names),
            "covariance": self.covariance.tolist(),
            "rmse_kpa": self.rmse_kpa,
            "log_likelihood": self.log_likelihood,
            "warnings": list(self.warnings),
        }

    def plot(self, *, ax: Axes | Sequence[Axes] | None = None) -> list[Axes]:
        """Draw measurement and fit of each recording, one below the other.

        `ax` takes axes for each recording. The default is a new figure. Needs matplotlib.
        """
        from pumpmodel.plotting.fits import plot_jointly

        return plot_jointly(self, ax=ax)

    def _repr_html_(self) -> str:
        from pumpmodel._results.notebook.shown import jointly_html

        return jointly_html(self)

    def __repr__(self) -> str:
        """Return port, number of recordings and the parameters that were found."""
        found = ", ".join(
            f"{name}={estimate.value:.6g} ± {2 * estimate.standard:.2g}"
            for name, estimate in self.parameters.items()
            if not estimate.held
        )
        count = len(self.recordings)
        return f"JointlyIdentified({self.port}, {count} recordings: {found}; {len(self.warnings)} warnings)"

    def __eq__(self, other: object) -> bool:
        """Tell if values, warnings and measurements are equal."""
        if not isinstance(other, JointlyIdentified):
            return NotImplemented
        return self._key() == other._key() and all(
            np.array_equal(mine, theirs) for mine, theirs in zip(self._arrays(), other._arrays(), strict=True)
        )

    def __hash__(self) -> int:
        """Hash the values that are compared, except for the measurements."""
        return hash((self.port, self.line, self.covariance_names))

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle the arrays so that they are read-only again when they are loaded."""
        return _rebuild, self._raw

    def _key(self) -> tuple[Any, ...]:
        told = [(fit.parameters, fit.rows, fit.standard_kpa) for fit in self.recordings]
        return self.port, self.line, self.parameters, told, self.warnings

    def _arrays(self) -> list[_Array]:
        columns = [(fit.time_s, fit.measured_kpa, fit.fitted_kpa) for fit in self.recordings]
        return [self.covariance, *(array for column in columns for array in column)]


def _estimates(told: Iterable[tuple[str, float, float, bool]]) -> dict[str, Estimate]:
    return {name: Estimate(value, standard, held) for name, value, standard, held in told}


def _rebuild(port: Port, answer: Any, standards: tuple[float | None, ...]) -> JointlyIdentified:
    found = JointlyIdentified._of(port, answer, standards)
    for array in found._arrays():
        array.setflags(write=False)
    return found


def identify_line_jointly(
    pump: Pump,
    recordings: Iterable[PressureRecord],
    *,
    port: Port = "outlet",
    fit: Sequence[LineParameter] = ("R", "C", "L"),
) -> JointlyIdentified:
    """Find R, C and L of one line from several pressure records at once.

    Least squares on the model over all samples, with exact derivatives. The records have the line in common,
    and each has its own start angle, and its own start if that is sought. Their information adds: a speed
    that tells little of R tells it together with another.

    Parameters
    ----------
    pump : Pump
        Pump of the line. Its flow counts as known, and the search starts from its line.
    recordings : iterable of PressureRecord
        Records of one port, one at least, at any speeds, of any length and with any intervals.
    port : {"outlet", "inlet"}
        Port whose line is identified.
    fit : sequence of {"R", "C", "L", "reservoir", "start"}
        Parameters to seek; all others are held. "reservoir" is the pressure of the reservoir, one for all
        records. "start" is the time of the start of each record, which is found only near its `start_s`.

    Returns
    -------
    JointlyIdentified
        Line with R, C, L and `reservoir_kpa`, and each record with its `start_angle_deg` and `start_s`,
        sought or held. The standard uncertainties do not include a mismatch of the model: read `warnings`.

    Raises
    ------
    TypeError
        If a recording is no `PressureRecord`, or `fit` is a text.
    ValueError
        If an argument is not allowed, if the records do not determine the parameters, or if the search does
        not end. A fault of a record tells its place.

    Examples
    --------
    >>> import pumpmodel as pm
    >>> pump = pm.Pump.three_roller()
    >>> real = pump.replace(outlet=pump.outlet.replace(inertance_kpa_s2_ml=0.006))
    >>> runs = [real.simulate(speed_rpm=speed, duration_s=0.5, dt_s=2e-3) for speed in (40, 100)]
    >>> records = [
    ...     pm.PressureRecord(run.time_s, run.outlet_kpa, speed_rpm=speed, begin="step")
    ...     for run, speed in zip(runs, (40, 100))
    ... ]
    >>> found = pm.identify_line_jointly(pump, records)
    >>> round(found.line.inertance_kpa_s2_ml, 6)
    0.006
    """
    if isinstance(fit, str):
        raise TypeError(f'fit is a text, {fit[:40]!r}; allowed: a sequence of names, as ("R", "C", "L")')
    records = checks.items("recordings", recordings, PressureRecord)
    given = [record._given() for record in records]
    answer = core._identify_line_jointly(pump, port, given, list(fit))
    standards = tuple(None if kpa is None else float(kpa) for *_, kpa in given)
    return JointlyIdentified._of(port, answer, standards)
