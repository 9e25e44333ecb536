"""The report of a dose or a run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from pumpmodel._results.record import Record
from pumpmodel.choices import (
    Finish,
    InletLimit,
    LimitedBy,
    PhaseSource,
    Purpose,
    UncertaintySource,
    UncheckedLimit,
    VolumeBasis,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True)
class SharePrior(Record):
    """Prior of the pump's scatter that a share rests on, as weighed doses are too few to show it.

    `standard_ml` is the standard deviation of a dose of this volume by the prior, `over_pump_file` times that
    of the pump file. The prior is known to 1/sqrt(2 `degrees_of_freedom`) of itself.
    """

    weighed: int
    standard_ml: float
    over_pump_file: float
    degrees_of_freedom: int


@dataclass(frozen=True)
class Share(Record):
    """A source of uncertainty: standard uncertainty, share of the variance, and a remedy.

    `prior` is the prior that the share rests on; None if it was measured or is known otherwise.
    """

    _records: ClassVar[dict[str, type[Record]]] = {"prior": SharePrior}

    source: UncertaintySource
    standard_ml: float
    variance_percent: float
    remedy: str
    prior: SharePrior | None


@dataclass(frozen=True)
class Phase(Record):
    """The source of a start angle and its half width.

    Below 2 deg of half width the dose is planned from the angle as if it were exact. The half width then is
    in the range of the volume and in the share "angle" of the uncertainty.
    """

    known: bool
    source: PhaseSource
    half_width_deg: float


@dataclass(frozen=True)
class Ripple(Record):
    """Ripple of a flow: its departure from the mean over time, divided by the mean."""

    peak_to_peak: float
    rms: float


@dataclass(frozen=True)
class RippleAt(Record):
    """Ripple at one place: at constant speed, as planned, and as far as the pump and its angle are known.

    `planned` is the ripple at the stated start angle. `peak_to_peak_worst_angle` is the largest over the
    half width of that angle. `peak_to_peak_median` and `peak_to_peak_95` are the median and the 95th
    percentile over the errors of roller volume, engagement angle and start angle. The median is the
    ripple to expect: below that of `constant_speed`, the flow is smoother than at an even speed.
    """

    _records: ClassVar[dict[str, type[Record]]] = {"constant_speed": Ripple, "planned": Ripple}

    constant_speed: Ripple
    planned: Ripple
    peak_to_peak_worst_angle: float
    peak_to_peak_median: float
    peak_to_peak_95: float


@dataclass(frozen=True)
class CalibrationUsed(Record):
    """The calibration of a dose at its cruise speed."""

    version: int
    date: str
    displacement_factor: float
    zero_deg: float
    roller_volume_ml: float | None
    engagement_deg: float | None


@dataclass(frozen=True)
class ByWeight(Record):
    """The weighing of a dose that a balance ended: masses in g, volumes in mL, times in s.

    The balance was to show `target_g` and showed `mass_g`, in steps of `digit_g`. `at_rest` is False for a
    dose that was stopped: `mass_g` is then the last reading, and more still arrived. The pump turned for
    `turned_ml` by the model (`turned_least_ml` to `turned_most_ml` over the angles at which the rollers
    may have stood), and might turn for `most_ml`, in `stretches` that were weighed each. The balance
    stopped `stopped_by_balance` of them before the end of their plan. The dose reckoned with `reckoned_s`
    of flow that still arrives after a stop; `after_stop_s` is the mean over the stops on record.
    `dropped_ml` is the carry of earlier doses that was dropped. `before_ml` is the volume on the balance
    of the part that an earlier call made. A dose is done where no more than `tolerance_g` is missing, and
    `tolerance_by` says why: "digit", "drop" or "step". It took `took_s` with the weighing, None where the
    motor is simulated.
    """

    target_g: float
    mass_g: float
    at_rest: bool
    digit_g: float
    turned_ml: float
    turned_least_ml: float
    turned_most_ml: float
    most_ml: float
    stretches: int
    stopped_by_balance: int
    reckoned_s: float | None
    reckoned_learned: bool | None
    after_stop_s: float | None
    after_stop_spread_s: float | None
    after_stop_stops: int | None
    dropped_ml: float
    before_ml: float
    tolerance_g: float
    tolerance_by: str
    took_s: float | None


@dataclass(frozen=True)
class Profile(Record):
    """A flow over time that a run followed.

    `volume_ml` is its volume at the rollers and `time_s` its time from the first row to the last.
    `largest_departure_ml` is the largest distance of the volume at the rollers from the profile's at any
    moment: that of a motor step. It is None if the run was stopped or took longer than its profile, and so
    left it.
    """

    name: str
    volume_ml: float
    time_s: float
    largest_departure_ml: float | None


@dataclass(frozen=True)
class Run(Record):
    """The end and the mean flow of a run of continuous flow, or of a prime or purge for a time.

    `until` is the event that was to end it: "volume", "time", "stop" or "profile". `asked_s` is the requested
    time (s). `mean_flow_ml_s` is the delivered volume over the time of its motion (mL/s). `was_stopped` is
    True if it was stopped before the end of its plan. Both are None for a run that was only planned.
    `profile` is the flow over time that it followed, and None of any other run.
    """

    _records: ClassVar[dict[str, type[Record]]] = {"profile": Profile}

    until: str
    asked_s: float | None
    mean_flow_ml_s: float | None
    was_stopped: bool | None
    profile: Profile | None = None


@dataclass(frozen=True)
class Dose(Record):
    """A dose of a bench, run or planned: the fields of the command's JSON `dose/1`.

    Volumes are in mL and negative in reverse, angles in deg of the pump head, pressures in kPa absolute,
    times in s. `delivered_ml` is the volume that the vessel of a simulation received, or the model's volume
    of the steps that a motor made. It is None for a dose that was only planned. `completed` is True if the
    dose was delivered in full. `by_weight` is the weighing of a dose that a balance ended, and None of any
    other. `run` is the end and the mean flow of a run, and None of a volume that is dosed. `time` is that at
    which the dose began, RFC 3339 with the offset of the local clock, and `asked` the volume as it was typed.
    """

    _records: ClassVar[dict[str, type[Record]]] = {
        "calibration": CalibrationUsed,
        "uncertainty_budget": Share,
        "phase": Phase,
        "ripple_before": Ripple,
        "ripple_after": Ripple,
        "ripple_at_rollers": RippleAt,
        "ripple_at_line_end": RippleAt,
        "by_weight": ByWeight,
        "run": Run,
    }

    schema: str
    pump: str
    driver: str
    simulated: bool
    device: str | None
    purpose: Purpose
    requested_ml: float
    carry_in_ml: float
    planned_ml: float
    volume_least_ml: float
    volume_most_ml: float
    delivered_ml: float | None
    balance_g: float | None
    volume_basis: VolumeBasis
    calibration: CalibrationUsed | None
    speed_law_factor: float | None
    expanded_uncertainty_ml: float
    uncertainty_budget: tuple[Share, ...]
    phase: Phase
    start_angle_deg: float
    end_angle_deg: float
    steps: int
    steps_made: int | None
    retract_steps: int | None
    steps_per_rev: float
    retraction_ml: float | None
    retraction_completed: bool | None
    finish: Finish
    carry_ml: float
    carry_half_width_ml: float
    cruise_speed_rpm: float
    peak_speed_rpm: float
    cruise_flow_ml_s: float
    mean_flow_ml_s: float
    motion_s: float
    measured_motion_s: float | None
    settle_s: float | None
    backflow_ml: float | None
    reverse_flow_ml: float | None
    inlet_min_kpa: float | None
    inlet_max_kpa: float | None
    outlet_min_kpa: float | None
    outlet_max_kpa: float | None
    inlet_pressure_uncertainty_kpa: float | None
    outlet_pressure_uncertainty_kpa: float | None
    ambient_kpa: float
    torque_needed_n_m: float | None
    torque_available_n_m: float | None
    ripple_before: Ripple
    ripple_after: Ripple
    ripple_at_rollers: RippleAt
    ripple_at_line_end: RippleAt | None
    limited_by: LimitedBy
    inlet_limit_kpa: float | None
    inlet_limit: InletLimit | None
    limits_not_checked: tuple[UncheckedLimit, ...]
    warnings: tuple[str, ...]
    completed: bool
    by_weight: ByWeight | None = None
    run: Run | None = None
    time: str | None = None
    asked: str | None = None

    def to_dict(self) -> dict[str, Any]:
        """Return the dose as plain data: `by_weight` and `run` are keys of a dose that has them.

        Returns
        -------
        dict
            Numbers, texts, lists and dicts only, as in the command's JSON.
        """
        data = super().to_dict()
        for key in ("by_weight", "run"):
            if data[key] is None:
                del data[key]
        return data

    def plot(self, *, ax: Axes | None = None) -> Axes:
        """Draw the uncertainty budget, as `pumpmodel.plot_budget` does.

        Parameters
        ----------
        ax : Axes, optional
            Axes to draw in. By default a new figure.

        Returns
        -------
        Axes
            Axes with a bar for each source of uncertainty.

        Raises
        ------
        ImportError
            If matplotlib is missing, which `pip install './crates/pump-py[plot]'` brings.
        """
        from pumpmodel.plotting.doses import plot_budget

        return plot_budget(self, ax=ax)

    def _repr_html_(self) -> str:
        from pumpmodel._results.notebook.shown import dose_html

        return dose_html(self)

    def _title(self, volume_ml: str) -> str:
        """Return the purpose in words. A run until it is stopped is planned for the longest volume."""
        return "Run" if self.purpose == "run" else f"Dose of {volume_ml} mL"

    def __repr__(self) -> str:
        """Tell the requested and the delivered volume, from an unknown angle the range of it."""
        made = "planned" if self.delivered_ml is None else f"delivered_ml {self.delivered_ml:.6f}"
        if not self.phase.known:
            range_ml = f"between {self.volume_least_ml:.4f} and {self.volume_most_ml:.4f} mL"
            made = f"{range_ml}, planned_ml {self.planned_ml:.4f}"
        return (
            f"<{self._title(repr(self.requested_ml))} on '{self.pump}' ({self.driver}): {made}, "
            f"expanded_uncertainty_ml {self.expanded_uncertainty_ml:.4f}, completed {self.completed}>"
        )
