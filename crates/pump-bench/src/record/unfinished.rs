//! An unfinished dose: the rotor made a part of its steps, perhaps within bounds.

use pump_ctl::plan::Phase;
use pump_model::Pump;
use serde::{Deserialize, Serialize};

use super::Intent;

/// Dose that was begun and not finished.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Unfinished {
    /// Plan of the whole dose.
    pub intent: Intent,
    /// Fewest steps that were made.
    pub made_least: u64,
    /// Most steps that were made.
    pub made_most: u64,
    /// Count of the device at the start, if the device was lost on the way. Its count tells the steps made
    /// once it is met again.
    #[serde(default)]
    pub count_before: Option<i64>,
}

impl Unfinished {
    /// Returns true if a device that counted `moved` steps since the start stayed within the announced
    /// bounds.
    pub(crate) fn holds(&self, moved: i64) -> bool {
        let forward = moved.signum() != -self.intent.steps.signum();
        forward && (self.made_least..=self.made_most).contains(&moved.unsigned_abs())
    }

    /// Returns the middle of the possible angles, with the half width that covers them all.
    pub fn phase(&self) -> Phase {
        let [least, most] = [self.made_least, self.made_most].map(|made| self.intent.angle_after(made));
        Phase {
            angle_rad: 0.5 * (least + most),
            half_width_rad: self.intent.half_width_rad + 0.5 * (most - least).abs(),
        }
    }

    /// Returns the smallest and largest volume that the dose may have delivered, in mL. Both are negative in
    /// reverse.
    pub fn delivered_ml(&self, pump: &Pump) -> (f64, f64) {
        let [least, most] = [self.made_least, self.made_most].map(|made| self.intent.range_ml(pump, made));
        (least.0.min(most.0), least.1.max(most.1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::displacement::Correction;
    use crate::record::{Purpose, Terms};

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
