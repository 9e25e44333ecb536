//! What a journal says.

use pump_ctl::plan::{Phase, Plan};
use pump_model::Pump;
use pump_model::math::{TURN_RAD, wrap};
use serde::{Deserialize, Serialize};

use super::{PhaseSource, Purpose};
use crate::displacement::Correction;

use super::Terms;

/// One entry.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Entry {
    /// A dose is about to move the rotor.
    Intent(Intent),
    /// Of the dose under way `made` steps are made; from now on up to `may` may be.
    Progress {
        /// Steps known to be made.
        made: u64,
        /// Steps that may be made before the next entry.
        may: u64,
    },
    /// The rotor stands.
    Rest {
        /// Since when, seconds since 1970 by the clock of the day; for people only.
        unix_s: u64,
        /// Why.
        why: Why,
        /// How things stand.
        state: State,
    },
}

/// Why the rotor stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Why {
    /// The dose was delivered.
    Done,
    /// The user stopped it.
    Stopped,
    /// The drive failed, or the journal could not be written.
    Fault,
    /// The process that ran the dose ended before it could say more.
    CutOff,
    /// An unfinished dose was accepted as it is.
    Discarded,
    /// Its angle was set by hand.
    Set,
    /// Its angle was found by the mark.
    Mark,
    /// Its angle was found by the index sensor.
    Sensor,
    /// The device was met in another state than it was left in.
    Met,
    /// The motor was let go.
    Released,
    /// The tube was exchanged.
    NewTube,
}

/// A dose as it was planned.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Intent {
    /// When, seconds since 1970 by the clock of the day; for people only.
    pub unix_s: u64,
    /// Why the pump is to turn.
    pub purpose: Purpose,
    /// Volume asked for, mL; negative in reverse.
    pub requested_ml: f64,
    /// What earlier doses owed, mL.
    pub carry_in_ml: f64,
    /// Volume of the planned steps, mL.
    pub planned_ml: f64,
    /// What the next dose will owe, mL.
    pub carry_out_ml: f64,
    /// Angle at the start, rad.
    pub start_angle_rad: f64,
    /// The true angle lies within this of it, rad.
    pub half_width_rad: f64,
    /// Motor steps; negative in reverse.
    pub steps: i64,
    /// Angle of a step, rad.
    pub step_rad: f64,
    /// Time of the motion, s.
    pub motion_s: f64,
    /// What is to be sucked back afterwards, mL.
    #[serde(default)]
    pub retract_ml: Option<f64>,
    /// What else was asked of it.
    #[serde(default, skip_serializing_if = "Terms::is_none")]
    pub terms: Terms,
    /// The calibration that it was planned with.
    #[serde(default, skip_serializing_if = "Correction::is_none")]
    pub correction: Correction,
}

/// How things stand with a pump between doses.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct State {
    /// Angle of the rotor in the model's zero, rad, in [0, 2 pi).
    pub angle_rad: f64,
    /// The true angle lies within this of it, rad.
    pub half_width_rad: f64,
    /// What doses owe, mL, positive toward the outlet.
    pub carry_ml: f64,
    /// What the tube has gone through.
    pub wear: Wear,
    /// A dose that was begun and not finished.
    pub unfinished: Option<Unfinished>,
    /// Where the angle comes from.
    #[serde(default)]
    pub source: PhaseSource,
    /// The device's own count of steps, positive toward the outlet; none if it has none, or if it was not asked.
    #[serde(default)]
    pub count: Option<i64>,
    /// How often since its angle was last found the rotor was let go, its device reset or lost.
    #[serde(default)]
    pub disturbances: u8,
    /// Whether the motor was let go on purpose: waking the device is no disturbance of its own then.
    #[serde(default)]
    pub released: bool,
}

/// What a tube has gone through since it was new.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Wear {
    /// Volume either way, mL.
    pub volume_ml: f64,
    /// Revolutions either way.
    pub revolutions: f64,
    /// Time in motion, s.
    pub motion_s: f64,
}

/// A dose that was begun and not finished.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Unfinished {
    /// The dose.
    pub intent: Intent,
    /// At least these steps were made.
    pub made_least: u64,
    /// At most these.
    pub made_most: u64,
    /// What the device counted at the start, if it was lost on the way: met again, its count tells what was made.
    #[serde(default)]
    pub count_before: Option<i64>,
}

impl Intent {
    /// Where the rollers stood at the start.
    pub fn start(&self) -> Phase {
        Phase { angle_rad: self.start_angle_rad, half_width_rad: self.half_width_rad }
    }

    /// Angle after `made` steps, rad, unwrapped: the same as the plan's.
    pub fn angle_after(&self, made: u64) -> f64 {
        let direction = if self.steps < 0 { -1.0 } else { 1.0 };
        self.start_angle_rad + direction * (made as f64 * self.step_rad)
    }

    /// Volume of the first `made` steps from the middle of the angles that may be, mL; negative in reverse.
    pub fn delivered_ml(&self, pump: &Pump, made: u64) -> f64 {
        self.correction.volume_ml(pump, self.start_angle_rad, self.angle_after(made))
    }

    /// Smallest and largest volume of the first `made` steps from an angle at which the rollers may have stood, mL.
    fn range_ml(&self, pump: &Pump, made: u64) -> (f64, f64) {
        if self.half_width_rad == 0.0 {
            let volume_ml = self.delivered_ml(pump, made);
            return (volume_ml, volume_ml);
        }
        let direction = if self.steps < 0 { -1.0 } else { 1.0 };
        self.correction.range_ml(pump, self.start(), direction * (made as f64 * self.step_rad))
    }

    /// What `plan` is going to do.
    pub(crate) fn of(
        plan: &Plan,
        correction: Correction,
        purpose: Purpose,
        carry_out_ml: f64,
        unix_s: u64,
    ) -> Self {
        Self {
            unix_s,
            purpose,
            requested_ml: plan.requested_ml,
            carry_in_ml: plan.carry_in_ml,
            planned_ml: plan.planned_ml,
            carry_out_ml,
            start_angle_rad: plan.start.angle_rad,
            half_width_rad: plan.start.half_width_rad,
            steps: plan.steps,
            step_rad: plan.step_rad,
            motion_s: plan.profile.duration_s(),
            retract_ml: None,
            terms: Terms::default(),
            correction,
        }
    }
}

impl Unfinished {
    /// Whether a device that has counted `moved` steps since the start is within what was announced.
    pub(crate) fn holds(&self, moved: i64) -> bool {
        let forward = moved.signum() != -self.intent.steps.signum();
        forward && (self.made_least..=self.made_most).contains(&moved.unsigned_abs())
    }

    /// Where the rollers stand: the middle of what is possible, and how far off it may be.
    pub fn phase(&self) -> Phase {
        let [least, most] = [self.made_least, self.made_most].map(|made| self.intent.angle_after(made));
        Phase {
            angle_rad: 0.5 * (least + most),
            half_width_rad: self.intent.half_width_rad + 0.5 * (most - least).abs(),
        }
    }

    /// Smallest and largest volume that it may have delivered, mL; both negative in reverse.
    pub fn delivered_ml(&self, pump: &Pump) -> (f64, f64) {
        let [least, most] = [self.made_least, self.made_most].map(|made| self.intent.range_ml(pump, made));
        (least.0.min(most.0), least.1.max(most.1))
    }
}

impl State {
    /// A rotor at `phase` that owes nothing, with a new tube.
    pub fn fresh(phase: Phase, source: PhaseSource) -> Self {
        Self {
            angle_rad: wrap(phase.angle_rad, TURN_RAD),
            half_width_rad: phase.half_width_rad,
            carry_ml: 0.0,
            wear: Wear::default(),
            unfinished: None,
            source,
            count: None,
            disturbances: 0,
            released: false,
        }
    }

    /// The same with the angle found: what doses owed is forgotten.
    pub(crate) fn found(self, phase: Phase, source: PhaseSource) -> Self {
        Self { carry_ml: 0.0, source, disturbances: 0, ..self.at(phase) }
    }

    /// The same after the rotor was let go and caught again, or may have been: it fell by `by_rad` at most. Who has seen
    /// this twice knows nothing.
    pub(crate) fn disturbed(self, by_rad: f64, pitch_rad: f64) -> Self {
        let disturbances = self.disturbances.saturating_add(1);
        let wider = Phase { half_width_rad: self.half_width_rad + by_rad, ..self.phase() };
        let stands = if disturbances < 2 { self.at(wider) } else { self.lost(pitch_rad) };
        Self { disturbances, ..stands }
    }

    /// The same once a device that was lost in the midst of the unfinished dose `part` has told that it made `made` steps of it.
    /// What else made the angle less sure stays.
    pub(crate) fn recounted(self, part: &Unfinished, made: u64) -> Self {
        let exact = Unfinished { made_least: made, made_most: made, count_before: None, ..*part };
        let disturbed_rad = (self.half_width_rad - part.phase().half_width_rad).max(0.0);
        let Phase { angle_rad, half_width_rad } = exact.phase();
        let all = part.intent.steps.unsigned_abs();
        Self {
            carry_ml: if made == all { part.intent.carry_out_ml } else { self.carry_ml },
            unfinished: (made < all).then_some(exact),
            ..self.at(Phase { angle_rad, half_width_rad: half_width_rad + disturbed_rad })
        }
    }

    /// The same with the angle unknown.
    pub(crate) fn lost(self, pitch_rad: f64) -> Self {
        self.at(Phase::unknown(pitch_rad))
    }

    /// The same with the rotor at `phase`.
    pub fn at(self, phase: Phase) -> Self {
        Self { angle_rad: wrap(phase.angle_rad, TURN_RAD), half_width_rad: phase.half_width_rad, ..self }
    }

    /// Where the rollers stand.
    pub fn phase(&self) -> Phase {
        Phase { angle_rad: self.angle_rad, half_width_rad: self.half_width_rad }
    }

    /// The state once `intent` has made `made_least` to `made_most` of its steps and stands there.
    pub(crate) fn after(self, intent: &Intent, made_least: u64, made_most: u64, pump: &Pump) -> Self {
        let all = intent.steps.unsigned_abs();
        let part = Unfinished { intent: *intent, made_least, made_most, count_before: None };
        let wear = Wear {
            volume_ml: self.wear.volume_ml + intent.delivered_ml(pump, made_most).abs(),
            revolutions: self.wear.revolutions + made_most as f64 * intent.step_rad / TURN_RAD,
            motion_s: self.wear.motion_s + intent.motion_s * made_most as f64 / all as f64,
        };
        let finished = made_least == all;
        Self {
            carry_ml: match intent.purpose {
                _ if finished => intent.carry_out_ml,
                // The middle of what may have been sucked back.
                Purpose::Retract => self.carry_ml - middle(intent, made_least, made_most, pump),
                _ => self.carry_ml,
            },
            wear,
            unfinished: (!finished && intent.purpose.is_delivery()).then_some(part),
            source: PhaseSource::Recorded,
            ..self
        }
        .at(part.phase())
    }
}

/// Middle of the volumes of the steps that may have been made, mL.
fn middle(intent: &Intent, made_least: u64, made_most: u64, pump: &Pump) -> f64 {
    0.5 * (intent.delivered_ml(pump, made_least) + intent.delivered_ml(pump, made_most))
}

#[cfg(test)]
mod tests {
    use super::*;

    const PITCH_RAD: f64 = TURN_RAD / 3.0;
    const FALL_RAD: f64 = TURN_RAD / 100.0;

    #[test]
    fn a_rotor_that_was_let_go_once_is_known_less_well_and_twice_not_at_all() {
        let stood = State::fresh(Phase { angle_rad: 1.0, half_width_rad: 0.01 }, PhaseSource::Home);
        let once = stood.disturbed(FALL_RAD, PITCH_RAD);
        assert_eq!((once.angle_rad, once.half_width_rad), (1.0, 0.01 + FALL_RAD));
        assert!(!once.disturbed(FALL_RAD, PITCH_RAD).phase().is_known(PITCH_RAD));
        let found = once.found(Phase::known(2.0), PhaseSource::Mark);
        assert!(found.disturbed(FALL_RAD, PITCH_RAD).phase().is_known(PITCH_RAD), "found anew");
    }

    #[test]
    fn a_rotor_that_was_turned_to_a_mark_leaves_nothing_to_resume() {
        let intent = Intent {
            unix_s: 0,
            purpose: Purpose::Jog,
            requested_ml: 1.0,
            carry_in_ml: 0.0,
            planned_ml: 1.0,
            carry_out_ml: 0.25,
            start_angle_rad: 1.0,
            half_width_rad: 0.0,
            steps: -1000,
            step_rad: 0.001,
            motion_s: 1.0,
            retract_ml: None,
            terms: Terms::default(),
            correction: Correction::NONE,
        };
        let before = State { carry_ml: 0.25, ..State::fresh(Phase::known(1.0), PhaseSource::Home) };
        let after = before.after(&intent, 400, 600, &Pump::three_roller());
        assert_eq!(after.unfinished, None);
        assert_eq!((after.angle_rad, after.carry_ml), (0.5, 0.25));
        assert!((after.half_width_rad - 0.1).abs() < 1e-12);
    }

    #[test]
    fn a_count_is_within_what_was_announced_only_in_its_direction() {
        let unfinished = |steps| Unfinished {
            intent: Intent {
                unix_s: 0,
                purpose: Purpose::Dose,
                requested_ml: 1.0,
                carry_in_ml: 0.0,
                planned_ml: 1.0,
                carry_out_ml: 0.0,
                start_angle_rad: 0.0,
                half_width_rad: 0.0,
                steps,
                step_rad: 0.001,
                motion_s: 1.0,
                retract_ml: None,
                terms: Terms::default(),
                correction: Correction::NONE,
            },
            made_least: 0,
            made_most: 500,
            count_before: None,
        };
        assert!([0, 1, 500].iter().all(|moved| unfinished(900).holds(*moved)));
        assert!([-1, 501].iter().all(|moved| !unfinished(900).holds(*moved)));
        assert!([0, -1, -500].iter().all(|moved| unfinished(-900).holds(*moved)));
        assert!([1, -501].iter().all(|moved| !unfinished(-900).holds(*moved)));
    }
}
