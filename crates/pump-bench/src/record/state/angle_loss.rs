//! The cause for which the rotor's angle, once known, is unknown.

use serde::{Deserialize, Serialize};

use crate::words::words;

/// Cause for which the rotor's angle, once known, is unknown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum AngleLoss {
    /// The rotor may have moved unseen twice since its angle was found, or once by too much.
    Disturbed,
    /// The stepper driver lost the motor's current in motion.
    CurrentLost,
    /// The emergency stop has cut the motor's current.
    EmergencyStop,
    /// Another program has had the board, or it is another board.
    TakenOver,
    /// The device's count is not the one on record.
    OtherCount,
    /// The motion ended with steps that nobody has counted, over a pitch and more.
    UncountedSteps,
    /// The pump file describes another head than before.
    OtherHead,
    /// The pump file's motor has other steps than before, or turns the other way.
    OtherSteps,
}

impl AngleLoss {
    /// Returns the cause in words, as a clause of its own.
    pub fn told(self) -> &'static str {
        match self {
            Self::Disturbed => {
                "the rotor may have moved unseen, by a reset, without current, or in a stop without a ramp, too often \
                 or too far since its angle was found"
            }
            Self::CurrentLost => "the stepper driver lost the motor's current in motion",
            Self::EmergencyStop => {
                "the emergency stop cut the motor's current, and people may have turned the rotor"
            }
            Self::TakenOver => "another program or another board may have turned the rotor",
            Self::OtherCount => {
                "the device's count does not follow from the steps on record: something else has moved the motor, or \
                 it was stopped at once"
            }
            Self::UncountedSteps => "the last motion ended with steps that nobody has counted",
            Self::OtherHead => "the pump file describes another head than before",
            Self::OtherSteps => {
                "the pump file's motor has other steps per revolution of the head than before, or turns the other way"
            }
        }
    }
}

words!(AngleLoss {
    Disturbed = "disturbed",
    CurrentLost = "current_lost",
    EmergencyStop = "emergency_stop",
    TakenOver = "taken_over",
    OtherCount = "other_count",
    UncountedSteps = "uncounted_steps",
    OtherHead = "other_head",
    OtherSteps = "other_steps",
});

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn records_and_reports_name_a_cause_by_its_word() {
        for cause in AngleLoss::ALL {
            assert_eq!(serde_json::to_string(cause).unwrap(), format!("\"{cause}\""));
        }
    }
}
