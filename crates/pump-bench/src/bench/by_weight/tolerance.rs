//! The volume by which a dose by weight may lack when it is done, and the reason.

use core::fmt;

use crate::numbers::significant;
use crate::words::words_of_reports;

/// Reason for which a dose by weight comes no nearer to its mass.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ToleranceBy {
    /// The balance shows no less than a digit.
    Digit,
    /// A drop falls whole, so that nothing comes nearer than half of one.
    Drop,
    /// The motor makes whole steps.
    Step,
}

words_of_reports!(ToleranceBy { Digit = "digit", Drop = "drop", Step = "step" });

/// Volume by which a dose by weight may lack when it is done.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Tolerance {
    pub(super) volume_ml: f64,
    pub(super) by: ToleranceBy,
}

impl Tolerance {
    /// Returns the largest of a digit, half a drop and a motor step, in mL.
    pub(super) fn of(digit_ml: f64, drop_ml: f64, step_ml: f64) -> Self {
        let digit = Self { volume_ml: digit_ml, by: ToleranceBy::Digit };
        let drop = Self { volume_ml: 0.5 * drop_ml, by: ToleranceBy::Drop };
        let step = Self { volume_ml: step_ml, by: ToleranceBy::Step };
        [drop, step]
            .into_iter()
            .fold(digit, |most, one| if one.volume_ml > most.volume_ml { one } else { most })
    }
}

/// Words the volume with its reason, as `half a drop, 30 µL`.
impl fmt::Display for Tolerance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let reason = match self.by {
            ToleranceBy::Digit => "a digit of its balance",
            ToleranceBy::Drop => "half a drop",
            ToleranceBy::Step => "a motor step",
        };
        write!(f, "{reason}, {} \u{b5}L", significant(1e3 * self.volume_ml, 3))
    }
}
