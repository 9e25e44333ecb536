//! The state of a pump between doses.

use pump_ctl::plan::Phase;
use pump_model::Pump;
use pump_model::math::{TURN_RAD, wrap};
use serde::{Deserialize, Serialize};

use super::{Intent, PhaseSource, Purpose, Unfinished, Wear};

/// State of a pump between doses.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct State {
    /// Angle of the rotor from the model's zero, in rad, in [0, 2 pi).
    pub angle_rad: f64,
    /// Half width of the range around the angle that holds the true angle, in rad.
    pub half_width_rad: f64,
    /// Carry to the next dose, in mL. Positive toward the outlet.
    pub carry_ml: f64,
    /// Wear of the tube.
    pub wear: Wear,
    /// Dose that was begun and not finished.
    pub unfinished: Option<Unfinished>,
    /// Source of the angle.
    #[serde(default)]
    pub source: PhaseSource,
    /// Step count of the device, positive toward the outlet. `None` if the device has no count or was not
    /// asked.
    #[serde(default)]
    pub count: Option<i64>,
    /// Number of times that the rotor was released, or its device reset or lost, since the angle was last
    /// found.
    #[serde(default)]
    pub disturbances: u8,
    /// True if the motor was released on purpose. Waking the device is then no further disturbance.
    #[serde(default)]
    pub released: bool,
}

impl State {
    /// Returns the state of a rotor at `phase` with a new tube and without carry.
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

    /// Returns the state once the angle is found at `phase`. The carry is dropped.
    pub(crate) fn found(self, phase: Phase, source: PhaseSource) -> Self {
        Self { carry_ml: 0.0, source, disturbances: 0, ..self.at(phase) }
    }

    /// Returns the state after the rotor may have been released and caught again. It fell by `by_rad` at
    /// most.
    ///
    /// After the second such disturbance the angle is unknown.
    pub(crate) fn disturbed(self, by_rad: f64, pitch_rad: f64) -> Self {
        let disturbances = self.disturbances.saturating_add(1);
        let wider = Phase { half_width_rad: self.half_width_rad + by_rad, ..self.phase() };
        let stands = if disturbances < 2 { self.at(wider) } else { self.lost(pitch_rad) };
        Self { disturbances, ..stands }
    }

    /// Returns the state once a lost device reports that it made `made` steps of the unfinished dose `part`.
    ///
    /// Any other uncertainty of the angle stays.
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

    /// Returns the state with the angle unknown.
    pub(crate) fn lost(self, pitch_rad: f64) -> Self {
        self.at(Phase::unknown(pitch_rad))
    }

    /// Returns the state with the rotor at `phase`.
    #[must_use]
    pub fn at(self, phase: Phase) -> Self {
        Self { angle_rad: wrap(phase.angle_rad, TURN_RAD), half_width_rad: phase.half_width_rad, ..self }
    }

    /// Returns the angle of the rotor, with its half width.
    pub fn phase(&self) -> Phase {
        Phase { angle_rad: self.angle_rad, half_width_rad: self.half_width_rad }
    }

    /// Returns the state once the rotor stands after `made_least` to `made_most` steps of `intent`.
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
                // The volume sucked back is known within bounds: its middle counts.
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

/// Returns the middle of the volumes of the fewest and the most steps made, in mL.
fn middle(intent: &Intent, made_least: u64, made_most: u64, pump: &Pump) -> f64 {
    0.5 * (intent.delivered_ml(pump, made_least) + intent.delivered_ml(pump, made_most))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::displacement::Correction;
    use crate::record::Terms;

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
}
