//! The state after a disturbance of the rotor, and that of another head or motor than the one on record.

use pump_ctl::plan::Phase;
use pump_model::Pump;
use pump_model::units::{TURN_RAD, wrap};

use super::super::{Intent, Purpose, Unfinished};
use super::{AngleLoss, PumpState, UNKNOWN_RAD};

/// Relative difference between the angles of two steps that is rounding.
const SAME_STEPS: f64 = 1e-9;

impl PumpState {
    /// Returns the state as the head with the print `head` takes it. The angle of another head tells nothing of this
    /// one's: it is unknown then, and nothing is carried, unless it belongs to an unfinished dose.
    #[must_use]
    pub(crate) fn of_head(self, head: Option<u32>, pump: &Pump) -> Self {
        let state = Self { head: head.or(self.head), ..self };
        if !self.is_of_another_head(head) {
            return state;
        }
        let state = if self.unfinished.is_some() { state } else { state.without_carry() };
        Self { last: None, ..state.lost(AngleLoss::OtherHead, pump) }
    }

    /// Returns the state whose unfinished dose has the volumes of its own day for `pump`, whose file may give others by
    /// now.
    #[must_use]
    pub(crate) fn of_volumes(self, pump: &Pump) -> Self {
        let of_then = |dose: Unfinished| Unfinished { intent: dose.intent.of_volumes(pump), ..dose };
        Self { unfinished: self.unfinished.map(of_then), ..self }
    }

    /// Returns true if the angle on record is of another head than the one with the print `head`.
    pub(crate) fn is_of_another_head(&self, head: Option<u32>) -> bool {
        self.head.zip(head).is_some_and(|(then, now)| then != now)
    }

    /// Returns the state as a motor with steps of `step_rad` takes it. If the motions on record were of other steps,
    /// they were wrong by the pump file of then or are by that of now, so nobody knows where they led.
    #[must_use]
    pub(crate) fn of_steps(self, step_rad: f64, pump: &Pump) -> Self {
        if !self.is_of_other_steps(step_rad) {
            return self;
        }
        let state = if self.unfinished.is_some() { self } else { self.without_carry() };
        Self { last: None, step_rad: None, ..state.lost(AngleLoss::OtherSteps, pump) }
    }

    /// Returns true if the motions since the angle was last found were of other steps than `step_rad`.
    pub(crate) fn is_of_other_steps(&self, step_rad: f64) -> bool {
        self.step_rad.is_some_and(|then| (then / step_rad - 1.0).abs() > SAME_STEPS)
    }

    /// Returns the state after the rotor may have been released and caught again. It fell by `by_rad` at
    /// most.
    ///
    /// After the second such disturbance the angle is unknown.
    pub(crate) fn disturbed(self, by_rad: f64, pump: &Pump) -> Self {
        let disturbances = self.disturbances.saturating_add(1);
        if disturbances >= 2 {
            return Self { disturbances, ..self.lost(AngleLoss::Disturbed, pump) };
        }
        let wider = Phase::within(self.angle_rad, self.half_width_rad + by_rad);
        let lost_by = self.lost_by_now(wider, AngleLoss::Disturbed, pump);
        Self { disturbances, lost_by, ..self.closed(pump).at(wider) }
    }

    /// Returns the state of a rotor whose motor was stopped in motion without a ramp. It may have slipped by so many
    /// steps, and so may the dose that the stop has left unfinished. In all it may stand `by_rad` from its steps.
    pub(crate) fn halted(self, slip_steps: u32, by_rad: f64, pump: &Pump) -> Self {
        let ended_here = |part: &Unfinished| wrap(part.phase().angle_rad(), TURN_RAD) == self.angle_rad;
        let unfinished = self.unfinished.map(|part| {
            // A turn to find the angle after that dose has slipped in its place.
            if ended_here(&part) { part.slipped(slip_steps.into()) } else { part }
        });
        Self { unfinished, ..self.disturbed(by_rad, pump) }
    }

    /// Returns the state of a rotor whose motor had no current, from some step of its last motion on or from its begin,
    /// which nobody knows. It has made `most` of the steps at most.
    pub(crate) fn without_current(self, intent: &Intent, most: i64, pump: &Pump) -> Self {
        self.after(intent, most.min(0), most.max(0), pump).lost(AngleLoss::CurrentLost, pump)
    }

    /// Returns the state once a lost device reports that it made `made` steps of the unfinished dose `part`. A rotor
    /// that was disturbed may have fallen by `fall_rad`.
    ///
    /// Any other uncertainty of the angle stays, and an angle that is unknown stays unknown, unless the bounds of the
    /// steps alone have made it so.
    pub(crate) fn recounted(self, part: &Unfinished, made: i64, fall_rad: f64, pump: &Pump) -> Self {
        let exact = Unfinished { made_least: made, made_most: made, count_before: None, ..*part };
        let (bounded, counted) = (part.phase(), exact.phase());
        let knows = |phase: Phase| phase.is_known(pump.pitch_rad());
        let is_as_left = wrap(bounded.angle_rad(), TURN_RAD) == self.angle_rad && self.disturbances < 2;
        let wider = |by_rad| Phase::within(counted.angle_rad(), counted.half_width_rad() + by_rad);
        let phase = match () {
            () if knows(self.phase()) => wider((self.half_width_rad - bounded.half_width_rad()).max(0.0)),
            () if is_as_left && !knows(bounded) => wider(f64::from(self.disturbances) * fall_rad),
            () => self.phase(),
        };
        let all = part.intent.steps.abs();
        let lost_by = self.lost_by.filter(|_| !knows(phase));
        let closed = self.closed(pump);
        let surer_ml = part.intent.carry_in_half_width_ml + exact.unsure_ml(pump);
        let carry_half_width_ml = match part.intent.purpose {
            Purpose::Dose => closed.carry_half_width_ml.min(surer_ml),
            _ => closed.carry_half_width_ml,
        };
        Self {
            carry_ml: if made == all { part.intent.carry_out_ml } else { self.carry_ml },
            carry_half_width_ml,
            unfinished: (made != all).then_some(exact),
            last: self.last.map(|dose| dose.recounted(part, made)),
            lost_by,
            ..closed.at(phase)
        }
    }

    /// Returns the state with the angle unknown, because of `cause` if it was known. Steps that nobody has counted are
    /// the lesser cause: a count may tell them later.
    pub(crate) fn lost(self, cause: AngleLoss, pump: &Pump) -> Self {
        let unknown = Phase::within(0.0, UNKNOWN_RAD);
        let lost_by = match self.lost_by {
            Some(AngleLoss::UncountedSteps) => Some(cause),
            _ => self.lost_by_now(unknown, cause, pump),
        };
        Self { lost_by, ..self.closed(pump).at(unknown) }
    }

    /// Returns the cause for which the angle is unknown once the rotor stands at `phase`: `cause` if it was known
    /// before. `None` if it is known then, or was never found.
    pub(super) fn lost_by_now(&self, phase: Phase, cause: AngleLoss, pump: &Pump) -> Option<AngleLoss> {
        let is_known = |phase: Phase| phase.is_known(pump.pitch_rad());
        match (is_known(self.phase()), is_known(phase)) {
            (_, true) => None,
            (true, false) => Some(cause),
            (false, false) => self.lost_by,
        }
    }
}
