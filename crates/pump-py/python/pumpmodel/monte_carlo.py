"""Volumes that a dose may deliver, drawn from the sources of its uncertainty."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from pumpmodel._pumpmodel import Plan, _number

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_Array = NDArray[np.float64]

# Part within twice the standard deviation of a normal distribution (GUM, JCGM 100:2008, table G.1).
_COVERAGE = math.erf(math.sqrt(2))

# Sources that are a factor of the whole volume.
_FACTORS = ("model", "calibration", "speed_dependence", "speed", "temperature")

# Sources of the start angle. It is stated, or known between wide bounds.
_ANGLES = ("angle", "phase")

# Angles over the width of the start angle at which the volume is compared with that of the plan.
_ANGLES_COMPARED = 256


@dataclass(frozen=True, eq=False)
class VolumeTrials:
    """Volumes of one dose in many trials, which `monte_carlo` returns.

    Attributes
    ----------
    volume_ml : numpy.ndarray
        Volume of each trial, mL, read-only, shape (trials,).
    budget_standard_ml : float
        Standard uncertainty by the budget of the plan, mL.
    budget_expanded_ml : float
        Expanded uncertainty by the budget of the plan, mL.
    """

    volume_ml: _Array
    budget_standard_ml: float
    budget_expanded_ml: float

    def __eq__(self, other: object) -> bool:
        """Tell if every volume and the budget are equal."""
        if not isinstance(other, VolumeTrials):
            return NotImplemented
        mine = (self.budget_standard_ml, self.budget_expanded_ml)
        return mine == (other.budget_standard_ml, other.budget_expanded_ml) and np.array_equal(
            self.volume_ml, other.volume_ml
        )

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle the volumes so that they are read-only again when they are loaded."""
        return _rebuild, (self.volume_ml, self.budget_standard_ml, self.budget_expanded_ml)

    @property
    def mean_ml(self) -> float:
        """Mean of the trials, mL."""
        return float(np.mean(self.volume_ml))

    @property
    def standard_ml(self) -> float:
        """Standard deviation of the trials, mL: the standard uncertainty of the volume."""
        return float(np.std(self.volume_ml, ddof=1))

    def interval_ml(self, coverage: float = _COVERAGE) -> tuple[float, float]:
        """Return the shortest interval that covers a part of the trials (JCGM 101:2008, 7.7).

        Parameters
        ----------
        coverage : float
            Part of the trials, above 0 and below 1. By default 0.9545, that of the expanded uncertainty.

        Returns
        -------
        tuple of float
            Smallest and largest volume, mL.

        Raises
        ------
        TypeError
            If `coverage` is no number.
        ValueError
            If `coverage` is not above 0 and below 1.
        """
        part = _number("coverage", coverage, "parts of 1")
        if not 0 < part < 1:
            message = f"coverage is {part:g}; allowed: above 0 and below 1"
            raise ValueError(message)
        ordered = np.sort(self.volume_ml)
        within = max(1, math.ceil(part * len(ordered)))
        widths = ordered[within - 1 :] - ordered[: len(ordered) - within + 1]
        first = int(np.argmin(widths))
        return float(ordered[first]), float(ordered[first + within - 1])

    def plot(self, *, ax: Axes | None = None) -> Axes:
        """Draw how often each volume occurs, beside the expanded uncertainty of the budget.

        Parameters
        ----------
        ax : Axes, optional
            Axes to draw in. By default a new figure.

        Returns
        -------
        Axes
            Axes over the volume.

        Raises
        ------
        ImportError
            If matplotlib is missing, which `pip install './crates/pump-py[plot]'` brings.
        """
        from pumpmodel.plotting.doses import plot_trials

        return plot_trials(self, ax=ax)

    def _repr_html_(self) -> str:
        from pumpmodel._results.notebook.knowledge import trials_html

        return trials_html(self)

    def __repr__(self) -> str:
        """Return the number of trials, their mean and the interval of 95.45 %."""
        least_ml, most_ml = self.interval_ml()
        return (
            f"VolumeTrials({len(self.volume_ml)} trials, mean {self.mean_ml:.5g} mL, "
            f"{least_ml:.5g} to {most_ml:.5g} mL)"
        )


def monte_carlo(plan: Plan, *, trials: int = 100_000, seed: int | None = None) -> VolumeTrials:
    """Draw the volumes that a planned dose may deliver, from each source of its uncertainty (JCGM 101:2008).

    The budget adds variances. The trials add the errors themselves:

    - The start angle is anywhere within its width with equal probability, and the volume of the same turn
      from there is computed exactly.
    - Model, calibration, speed and temperature are normal errors of the whole volume, as factors.
    - A motor step is rectangular (JCGM 100:2008, 4.3.7). The drop at the nozzle is the difference of two
      rectangular volumes.
    - Every other source is normal, with the standard uncertainty of the budget.

    Parameters
    ----------
    plan : Plan
        Planned dose.
    trials : int
        Number of trials, 2 to 10 million.
    seed : int, optional
        Seed of `numpy.random.default_rng`. By default each call draws anew.

    Returns
    -------
    VolumeTrials
        Volumes of the trials.

    Raises
    ------
    TypeError
        If `plan` is no `Plan`, or `trials` or `seed` is no whole number.
    ValueError
        If `trials` or `seed` is out of range.
    MemoryError
        If there is no memory for the trials.

    Examples
    --------
    >>> import pumpmodel as pm
    >>> plan = pm.Doser(pm.Pump.three_roller()).plan("1mL", start_angle_rad=0.3, start_half_width_rad=0.02)
    >>> drawn = pm.monte_carlo(plan, trials=20_000, seed=1)
    >>> bool(abs(drawn.standard_ml / drawn.budget_standard_ml - 1) < 0.02)
    True
    """
    if not isinstance(plan, Plan):
        message = (
            f"plan must be a Plan, not {type(plan).__name__}; pm.Doser(pump).plan(volume) and"
            " bench.plan(volume) return one"
        )
        raise TypeError(message)
    _whole("trials", trials, 2, 10_000_000)
    if seed is not None:
        _whole("seed", seed, 0, 2**64 - 1)
    dice = np.random.default_rng(seed)
    shares = {share["source"]: float(share["standard_ml"]) for share in plan.uncertainty_budget}
    planned_ml = plan.planned_ml
    volumes_ml = _volumes_ml(plan, dice, trials)
    relative = [shares[source] / abs(planned_ml) for source in _FACTORS if shares.get(source, 0.0) > 0]
    for standard in relative:
        volumes_ml *= 1 + standard * dice.standard_normal(trials)
    for source, standard_ml in shares.items():
        if standard_ml == 0 or source in _FACTORS:
            continue
        if source == "step":
            volumes_ml += math.sqrt(3) * standard_ml * dice.uniform(-1, 1, trials)
        elif source == "drop":
            each_ml = math.sqrt(6) * standard_ml
            volumes_ml += each_ml * (dice.random(trials) - dice.random(trials))
        elif source in _ANGLES:
            left_ml = math.sqrt(max(0.0, standard_ml**2 - _angle_standard_ml(plan, source) ** 2))
            volumes_ml += left_ml * dice.standard_normal(trials)
        else:
            volumes_ml += standard_ml * dice.standard_normal(trials)
    volumes_ml.flags.writeable = False
    standard_ml = math.sqrt(sum(standard_ml**2 for standard_ml in shares.values()))
    return VolumeTrials(volumes_ml, standard_ml, plan.expanded_uncertainty_ml)


def _rebuild(volume_ml: _Array, standard_ml: float, expanded_ml: float) -> VolumeTrials:
    volume_ml.setflags(write=False)
    return VolumeTrials(volume_ml, standard_ml, expanded_ml)


def _whole(name: str, given: object, least: int, most: int) -> None:
    """Refuse what is no whole number within a range."""
    if isinstance(given, bool) or not isinstance(given, int | np.integer):
        message = f"{name} must be a whole number, not {type(given).__name__}"
        raise TypeError(message)
    number = int(given)
    if not least <= number <= most:
        told = str(number) if abs(number) < 2**64 else "a whole number beyond 64 bits"
        message = f"{name} is {told}; allowed: {least} to {most:,}"
        raise ValueError(message)


def _half_width_rad(plan: Plan) -> float:
    """Return the half width of the start angle. From half a pitch on, every angle is equally likely."""
    return min(plan.start_half_width_rad, 0.5 * plan.pump.pitch_rad)


def _turned_ml(plan: Plan, start_rad: _Array) -> _Array:
    """Return what the model's rollers deliver on the turn of the plan from each start angle, mL."""
    turn_rad = plan.end_angle_rad - plan.start_angle_rad
    volume_ml = plan.pump.outlet_volume_ml
    return volume_ml(start_rad + turn_rad) - volume_ml(start_rad)


def _compared_ml(plan: Plan) -> _Array:
    """Return the model's volumes from angles spread over the width of the start angle, mL."""
    parts = (2 * np.arange(_ANGLES_COMPARED) + 1) / _ANGLES_COMPARED - 1
    return _turned_ml(plan, plan.start_angle_rad + _half_width_rad(plan) * parts)


def _volumes_ml(plan: Plan, dice: np.random.Generator, trials: int) -> _Array:
    """Return the volumes of the plan's turn from random start angles, mL, with no other error."""
    if plan.start_half_width_rad == 0:
        return np.full(trials, plan.planned_ml)
    width_rad = _half_width_rad(plan)
    modelled_ml = _turned_ml(plan, plan.start_angle_rad + width_rad * dice.uniform(-1, 1, trials))
    # A calibration is a factor of every volume.
    return modelled_ml * (plan.planned_ml / _middle_ml(plan))


def _is_stated(plan: Plan) -> bool:
    """Return whether the dose was planned from its start angle itself, as the source of the share tells."""
    return any(share["source"] == "angle" and share["standard_ml"] > 0 for share in plan.uncertainty_budget)


def _middle_ml(plan: Plan) -> float:
    """Return the model's volume that the plan's stands for, mL: from its angle, or midway in its range."""
    if _is_stated(plan):
        return float(_turned_ml(plan, np.array([plan.start_angle_rad]))[0])
    compared_ml = _compared_ml(plan)
    return float(0.5 * (compared_ml.min() + compared_ml.max()))


def _angle_standard_ml(plan: Plan, source: str) -> float:
    """Return the part of an angle's share that the drawn start angles make, mL, as the budget takes it.

    The rest of the share is the uncertainty of the angle's zero.
    """
    if plan.start_half_width_rad == 0 or (source == "angle") != _is_stated(plan):
        return 0.0
    errors_ml = _compared_ml(plan) - _middle_ml(plan)
    mean_ml = float(np.sqrt(np.mean(errors_ml**2)))
    # The budget takes half of the largest error at least of an angle that is not stated.
    return mean_ml if source == "angle" else max(mean_ml, 0.5 * float(np.abs(errors_ml).max()))
