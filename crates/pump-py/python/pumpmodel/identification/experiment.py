"""The next experiment that tells most of a line."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from numbers import Real
from typing import TYPE_CHECKING, Any, ClassVar, Literal, TypeAlias, get_args

import numpy as np
from numpy.typing import NDArray

from pumpmodel._pumpmodel import Line, Pump
from pumpmodel._results import checks
from pumpmodel._results.numbers import Number, floats_of
from pumpmodel._results.record import Record
from pumpmodel.choices import Initial, Port
from pumpmodel.identification.identified import Identified
from pumpmodel.identification.joint import JointlyIdentified

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_Array: TypeAlias = NDArray[np.float64]

# Parameters of a line, in the order of the rows of a sensitivity.
_LINE = ("resistance_kpa_s_ml", "compliance_ml_kpa", "inertance_kpa_s2_ml")
# Row of the derivative by the start angle.
_ANGLE = 3


@dataclass(frozen=True)
class Experiment(Record):
    """A pressure record at constant speed that might be made: a candidate of `next_experiment`."""

    #: Speed of the pump head, r/min; negative in reverse.
    speed_rpm: Number
    #: Duration, s.
    duration_s: Number
    #: Time between samples, s.
    dt_s: Number = 1e-3
    #: Port at which the pressure is measured: "inlet" or "outlet".
    port: Port = "outlet"
    #: Angle of the pump head at the start, rad.
    start_angle_rad: Number = 0.0
    #: State at the start: "rest", or "steady" once start-up is forgotten.
    initial: Initial = "rest"

    def __post_init__(self) -> None:
        """Refuse what no experiment can have."""
        names = ("speed_rpm", "duration_s", "dt_s", "start_angle_rad")
        floats_of(self, *names)
        for name in names:
            if not math.isfinite(getattr(self, name)):
                raise ValueError(f"{name} is {getattr(self, name)}; allowed: a finite number")
        if self.speed_rpm == 0:
            raise ValueError("speed_rpm is 0; allowed: a finite speed other than 0")
        for name in ("duration_s", "dt_s"):
            if getattr(self, name) <= 0:
                raise ValueError(f"{name} is {getattr(self, name)}; allowed: a positive number in s")
        if self.dt_s > self.duration_s:
            raise ValueError(f"dt_s is {self.dt_s}; allowed: more than 0, duration_s at most")
        for name, allowed in (("port", get_args(Port)), ("initial", get_args(Initial))):
            if getattr(self, name) not in allowed:
                listed = ", ".join(map(repr, allowed))
                raise ValueError(f"{name} is {str(getattr(self, name))[:40]!r}; allowed: {listed}")


@dataclass(frozen=True)
class ExpectedFit(Record):
    """Knowledge that a fit of R, C and L would have after an experiment."""

    #: Experiment that might be made.
    experiment: Experiment
    #: Information gained on R, C and L together, nats: half the logarithm of the ratio of the determinants of
    #: their covariances before and after. 0.69 halves one standard uncertainty.
    gain_nats: float
    #: Expected standard uncertainty of R, kPa s/mL.
    resistance_kpa_s_ml: float
    #: Expected standard uncertainty of C, mL/kPa.
    compliance_ml_kpa: float
    #: Expected standard uncertainty of L, kPa s²/mL.
    inertance_kpa_s2_ml: float
    #: Those three over the values of R, C and L, %. A line without resistance has that of critical damping in
    #: place of R.
    relative_percent: tuple[float, float, float]

    _records: ClassVar[dict[str, type[Record]]] = {"experiment": Experiment}

    def plot(self, *, ax: Axes | None = None) -> Axes:
        """Draw the expected standard uncertainties of R, C and L, % of their values.

        `ax` takes axes. The default is a new figure. Needs matplotlib.
        """
        from pumpmodel.plotting.knowledge import plot_expected

        return plot_expected(self, ax=ax)

    def _repr_html_(self) -> str:
        from pumpmodel._results.notebook.knowledge import expected_html

        return expected_html(self)


def next_experiment(
    pump: Pump,
    candidates: Iterable[Experiment],
    *,
    standard_kpa: Number,
    known: Identified | JointlyIdentified | None = None,
    unknown: Iterable[Literal["start_angle", "reservoir"]] = (),
) -> tuple[ExpectedFit, ...]:
    """Rank experiments by what their records are expected to tell of a line (D-optimal design).

    The Fisher information of a record follows from the exact derivatives of its pressures, at the line that
    is known now. It adds to the information before.

    Parameters
    ----------
    pump : Pump
        Pump with the line as it is known now.
    candidates : iterable of Experiment
        Experiments that might be made, one at least, at one port.
    standard_kpa : float
        Standard deviation of the noise of a sample, kPa, 1e-9 to 1e9. The noise of different samples is
        taken as independent.
    known : Identified or JointlyIdentified, optional
        Earlier identification of this line: its values stand in place of the pump's, and its covariances are
        the knowledge before. Parameters that it held are known exactly. Without it each parameter is known
        to within its own size.
    unknown : iterable of {"start_angle", "reservoir"}
        Quantities that the fit of the new record has to find too.

    Returns
    -------
    tuple of ExpectedFit
        One for each candidate, the most informative first.

    Raises
    ------
    TypeError
        If `standard_kpa` is no number, or another argument is of another type.
    ValueError
        If an argument is not allowed, or a candidate cannot be simulated.

    Examples
    --------
    >>> import pumpmodel as pm
    >>> pump = pm.Pump.three_roller()
    >>> speeds = [pm.Experiment(speed_rpm=speed, duration_s=1) for speed in (20, 60, 150)]
    >>> [fit.experiment.speed_rpm for fit in pm.next_experiment(pump, speeds, standard_kpa=0.3)]
    [150, 60, 20]
    """
    if not isinstance(pump, Pump):
        raise TypeError(f"pump must be a Pump, not {type(pump).__name__}")
    if isinstance(standard_kpa, bool) or not isinstance(standard_kpa, Real):
        raise TypeError(f"standard_kpa must be a number in kPa, not {type(standard_kpa).__name__}")
    if not 1e-9 <= standard_kpa <= 1e9:
        raise ValueError(f"standard_kpa is {standard_kpa}; allowed: 1e-9 to 1e9")
    wanted = _named(unknown)
    for name in wanted:
        if name not in ("start_angle", "reservoir"):
            raise ValueError(f'{name!r} is not a quantity of unknown; allowed: "start_angle", "reservoir"')
    experiments = _experiments(candidates)
    ports = {experiment.port for experiment in experiments}
    if len(ports) != 1:
        raise ValueError(f"the candidates are of {len(ports)} ports; allowed: candidates of one port")
    port = ports.pop()
    if known is not None and not isinstance(known, Identified | JointlyIdentified):
        raise TypeError(
            f"known must be what an identification returned, as pm.identify_line, not {type(known).__name__}"
        )
    if known is not None and known.port != port:
        raise ValueError(
            f"known is of the {known.port}, but the candidates are of the {port}; allowed: one port"
        )
    line = (pump.inlet if port == "inlet" else pump.outlet) if known is None else known.line
    pump = pump.replace(inlet=line) if port == "inlet" else pump.replace(outlet=line)
    free, before = _before(line, known)
    fits = []
    for experiment in experiments:
        information = _information(pump, experiment, wanted, standard_kpa)
        after = before + information[np.ix_(free, free)] * np.outer(_sizes(line)[free], _sizes(line)[free])
        gain = 0.5 * (np.linalg.slogdet(after)[1] - np.linalg.slogdet(before)[1])
        standards = np.zeros(3)
        standards[free] = np.sqrt(np.diag(np.linalg.inv(after))) * _sizes(line)[free]
        resistance, compliance, inertance = (100 * standards / _sizes(line)).tolist()
        relative = (resistance, compliance, inertance)
        fits.append(ExpectedFit(experiment, float(gain), *map(float, standards), relative))
    return tuple(sorted(fits, key=lambda fit: -fit.gain_nats))


def _named(unknown: object) -> list[Any]:
    """Return the names of the unknown quantities."""
    if isinstance(unknown, str) or not isinstance(unknown, Iterable):
        told = f"a text, {unknown[:40]!r}" if isinstance(unknown, str) else f"a {type(unknown).__name__}"
        raise TypeError(f'unknown is {told}; allowed: a sequence of names, as ["start_angle", "reservoir"]')
    return list(unknown)


def _experiments(candidates: object) -> list[Experiment]:
    """Return the candidates, one at least."""
    experiments = checks.items("candidates", candidates, Experiment)
    if not experiments:
        raise ValueError("candidates is empty; allowed: one Experiment at least")
    return experiments


def _sizes(line: Line) -> _Array:
    """Return the size of each parameter: its value, or that of critical damping for no resistance."""
    critical = 2 * math.sqrt(line.inertance_kpa_s2_ml / line.compliance_ml_kpa)
    return np.array([line.resistance_kpa_s_ml or critical, line.compliance_ml_kpa, line.inertance_kpa_s2_ml])


def _before(line: Line, known: Identified | JointlyIdentified | None) -> tuple[list[int], _Array]:
    """Return the parameters that are not known exactly, and the information on them over their sizes."""
    if known is None:
        return [0, 1, 2], np.eye(3)
    sought = [name for name, estimate in known.parameters.items() if not estimate.held]
    free = [n for n, name in enumerate(_LINE) if name in sought]
    if not free:
        raise ValueError("known held R, C and L; allowed: an identification that sought one of them at least")
    places = [known.covariance_names.index(_LINE[n]) for n in free]
    sizes = _sizes(line)[free]
    covariance = known.covariance[np.ix_(places, places)] / np.outer(sizes, sizes)
    return free, np.asarray(np.linalg.inv(covariance), dtype=np.float64)


def _information(
    pump: Pump,
    experiment: Experiment,
    unknown: list[Literal["start_angle", "reservoir"]],
    standard_kpa: float,
) -> _Array:
    """Return the Fisher information of a record on R, C and L, beside the unknown quantities."""
    run = pump.simulate(
        speed_rpm=experiment.speed_rpm,
        duration_s=experiment.duration_s,
        dt_s=experiment.dt_s,
        start_angle_rad=experiment.start_angle_rad,
        initial=experiment.initial,
        sensitivity=True,
    )
    by = run.sensitivity.inlet_kpa_by if experiment.port == "inlet" else run.sensitivity.outlet_kpa_by
    slopes = by[:3].T / standard_kpa
    others = []
    if "start_angle" in unknown:
        others.append(by[_ANGLE])
    if "reservoir" in unknown:
        others.append(np.ones_like(run.time_s))
    if others:
        # The part of the slopes that the unknown quantities cannot imitate.
        basis = np.linalg.qr(np.stack(others, axis=1))[0]
        slopes = slopes - basis @ (basis.T @ slopes)
    information: _Array = slopes.T @ slopes
    return information
