//! An unfinished dose: the rotor made a part of its steps, perhaps within bounds.

use pump_ctl::plan::{Phase, Turned};
use pump_model::Pump;
use pump_model::units::{TURN_RAD, wrap};
use serde::{Deserialize, Serialize};

use super::intent::is_zero;
use super::{DeliveredRange, Intent, Purpose, Whole};
use crate::displacement::Correction;

/// Dose that was begun and not finished.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Unfinished {
    /// Plan of the whole dose.
    pub intent: Intent,
    /// Fewest net steps that were made in the dose's direction. Negative if the rotor may stand behind its
    /// start.
    pub made_least: i64,
    /// Most net steps that were made in the dose's direction. The dose may have fewer.
    pub made_most: i64,
    /// Count of the device at the start, if the device was lost on the way. Its count tells the steps made
    /// once it is met again.
    #[serde(default)]
    pub(crate) count_before: Option<i64>,
    /// Volume that turns to find the angle have pumped since the last motion of this dose, in mL, negative in reverse.
    /// It counts as not delivered. 0 in a record of an early version.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub(crate) searched_ml: f64,
}

impl Unfinished {
    /// Returns a motion of which `made_least` to `made_most` steps were made.
    pub(crate) fn of(intent: &Intent, made_least: i64, made_most: i64) -> Self {
        Self { intent: *intent, made_least, made_most, count_before: None, searched_ml: 0.0 }
    }

    /// Returns the volume that turns to find the angle have pumped while this dose was unfinished, in mL, negative in
    /// reverse. It counts as not delivered.
    pub(crate) fn searched_ml(&self) -> f64 {
        self.searched_ml + self.intent.whole.map_or(0.0, |whole| whole.searched_ml)
    }

    /// Returns this dose after `turn`, which was made to find the rotor's angle. The most that the turn may have pumped
    /// counts. The device's count is of the dose no more.
    pub(super) fn searched(self, turn: &Self, pump: &Pump) -> Self {
        let (least_ml, most_ml) = turn.counted_ml(pump);
        let turned_ml = if turn.intent.steps < 0 { least_ml.min(most_ml) } else { least_ml.max(most_ml) };
        Self { count_before: None, searched_ml: self.searched_ml + turned_ml, ..self }
    }

    /// Returns this dose after its motor was stopped at speed, and may have slipped by so many steps.
    pub(super) fn slipped(self, by: i64) -> Self {
        Self { made_least: self.made_least - by, made_most: self.made_most + by, ..self }
    }

    /// Returns true for a run that goes on until somebody stops it.
    pub fn is_endless(&self) -> bool {
        self.intent.terms.until_stopped
    }

    /// Returns true if a device that counted `moved` steps since the start stayed within the announced
    /// bounds.
    pub(crate) fn holds(&self, moved: i64) -> bool {
        (self.made_least..=self.made_most).contains(&(moved * self.intent.steps.signum()))
    }

    /// Returns the middle of the possible angles, with the half width that covers them all.
    pub(crate) fn phase(&self) -> Phase {
        let [least, most] = [self.made_least, self.made_most].map(|made| self.intent.angle_after(made));
        Phase::within(0.5 * (least + most), self.intent.half_width_rad + 0.5 * (most - least).abs())
    }

    /// Returns the volume that the dose has delivered, the motions before the last one included.
    pub(crate) fn delivered(&self, pump: &Pump) -> DeliveredRange {
        let whole = self.whole(pump);
        let (least_ml, most_ml) = self.intent.account(whole.turned).range_ml(pump);
        DeliveredRange {
            least_ml: whole.least_ml + least_ml,
            middle_ml: whole.booked_ml,
            most_ml: whole.most_ml + most_ml,
        }
    }

    /// Returns the volume that the last motion of this dose has delivered.
    pub(crate) fn motion_delivered(&self, pump: &Pump) -> DeliveredRange {
        self.intent.delivered(pump, self.made_least, self.made_most)
    }

    /// Returns the smallest and largest volume that the dose may have delivered, in mL, the motions before
    /// the last one included. Both are negative in reverse.
    pub fn delivered_ml(&self, pump: &Pump) -> (f64, f64) {
        self.delivered(pump).range_ml()
    }

    /// Returns true if the steps of all its motions are known exactly. A motion whose steps nobody knows, or whose
    /// rotor was disturbed, has its volumes on record as bounds.
    pub(crate) fn has_exact_steps(&self) -> bool {
        self.made_least == self.made_most
            && self.intent.whole.is_none_or(|whole| whole.least_ml == whole.most_ml)
    }

    /// Returns the volume that this dose is booked with so far, in mL, the motions before the last one
    /// included.
    pub(crate) fn booked_ml(&self, pump: &Pump) -> f64 {
        self.intent.whole.map_or(0.0, |whole| whole.booked_ml) + self.motion_booked_ml(pump)
    }

    /// Returns the volume that the last motion of this dose is booked with so far, in mL.
    pub(crate) fn motion_booked_ml(&self, pump: &Pump) -> f64 {
        self.intent.booked_ml(pump, self.made_least, self.made_most)
    }

    /// Returns the smallest and largest volume of the last motion that safety limits count, in mL: what it is booked
    /// with, or where nobody knows its steps, all that it may have delivered.
    pub(super) fn counted_ml(&self, pump: &Pump) -> (f64, f64) {
        if self.made_least == self.made_most {
            let booked_ml = self.motion_booked_ml(pump);
            return (booked_ml, booked_ml);
        }
        self.motion_delivered(pump).range_ml()
    }

    /// Returns the volume that safety limits count once the last motion is made to its end, beyond what they count
    /// already, in mL; negative in reverse. 0 for a retraction, and for a run until it is stopped, whose end nobody
    /// knows.
    pub(crate) fn still_to_count_ml(&self, pump: &Pump) -> f64 {
        if self.is_endless() || self.intent.purpose == Purpose::Retract {
            return 0.0;
        }
        let (least_ml, most_ml) = self.counted_ml(pump);
        let planned_ml = self.intent.planned_ml;
        if planned_ml < 0.0 {
            (planned_ml - least_ml.min(most_ml)).min(0.0)
        } else {
            (planned_ml - least_ml.max(most_ml)).max(0.0)
        }
    }

    /// Returns the most that the last motion may have pumped in its direction, in mL.
    pub(super) fn most_ml(&self, pump: &Pump) -> f64 {
        let (least_ml, most_ml) = self.motion_delivered(pump).range_ml();
        least_ml.abs().max(most_ml.abs())
    }

    /// Returns the largest error of the volume that this dose is booked with so far, in mL.
    pub(super) fn unsure_ml(&self, pump: &Pump) -> f64 {
        self.delivered(pump).half_width_ml()
    }

    /// Returns this dose as the whole of which a further motion makes the rest.
    fn whole(&self, pump: &Pump) -> Whole {
        let intent = &self.intent;
        let (before, turned) = match intent.whole {
            Some(whole) => ((whole.least_ml, whole.most_ml), whole.turned),
            None => ((0.0, 0.0), Turned::at(intent.start())),
        };
        Whole {
            requested_ml: intent.whole_requested_ml(),
            booked_ml: self.booked_ml(pump),
            least_ml: before.0,
            most_ml: before.1,
            turned: intent.turned_by(turned, self.made_least, self.made_most),
            searched_ml: self.searched_ml(),
        }
    }

    /// Returns this dose as the whole for a rest that starts at `stands` with `correction`.
    ///
    /// The turn goes on if nothing has disturbed the rotor since and the displacement is the one of before.
    /// Otherwise the volumes of both parts add up.
    pub(crate) fn whole_for_rest(&self, pump: &Pump, stands: Phase, correction: Correction) -> Whole {
        let whole = self.whole(pump);
        let ended = self.phase();
        let undisturbed = ended.moved_to(wrap(ended.angle_rad(), TURN_RAD));
        if undisturbed == stands && correction == self.intent.correction {
            return whole;
        }
        let (least_ml, most_ml) = self.delivered_ml(pump);
        Whole { least_ml, most_ml, turned: Turned::at(stands), ..whole }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::{DoseTerms, Purpose};

    #[test]
    fn a_count_is_within_what_was_announced_only_in_its_direction() {
        let unfinished = |steps| Unfinished {
            intent: Intent {
                unix_s: 0,
                purpose: Purpose::Dose,
                requested_ml: 1.0,
                carry_in_ml: 0.0,
                carry_in_half_width_ml: 0.0,
                planned_ml: 1.0,
                carry_out_ml: 0.0,
                start_angle_rad: 0.0,
                half_width_rad: 0.0,
                turned: None,
                steps,
                step_rad: 0.001,
                revolution_ml: None,
                inverted: false,
                motor_way: None,
                motion_s: 1.0,
                speed_rad_s: 1.0,
                retract_ml: None,
                whole: None,
                terms: DoseTerms::default(),
                correction: Correction::NONE,
                told: None,
            },
            made_least: 0,
            made_most: 500,
            count_before: None,
            searched_ml: 0.0,
        };
        assert!([0, 1, 500].iter().all(|moved| unfinished(900).holds(*moved)));
        assert!([-1, 501].iter().all(|moved| !unfinished(900).holds(*moved)));
        assert!([0, -1, -500].iter().all(|moved| unfinished(-900).holds(*moved)));
        assert!([1, -501].iter().all(|moved| !unfinished(-900).holds(*moved)));
    }
}
