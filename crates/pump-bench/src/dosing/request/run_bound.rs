//! The bound at which a run until it is stopped ends by itself.

use std::fmt;

use crate::safety::SafetyLimit;

/// Bound at which a run until it is stopped ends by itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum RunBound {
    /// A safety limit. The pump then stands.
    Safety(SafetyLimit),
    /// The life of the tube.
    Tube,
    /// The steps that the device can count.
    Count,
    /// The most volume, steps and time that one run may have.
    Most,
    /// The end that the run had when it was cut off. The record does not tell the reason.
    Rest,
}

impl RunBound {
    /// Returns the cause that the log has of a run that ended here by itself. `None` where the record tells none.
    pub(crate) fn cause(self) -> Option<String> {
        (self != Self::Rest).then(|| self.to_string())
    }
}

impl fmt::Display for RunBound {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        to.write_str(match self {
            Self::Safety(_) => "a safety limit is reached",
            Self::Tube => "the tube is nearly used up",
            Self::Count => {
                "the device counts its steps exactly no farther; one that is switched off and on counts from zero"
            }
            Self::Most => "no run may be longer",
            Self::Rest => "the whole run was to end here when it was cut off",
        })
    }
}
