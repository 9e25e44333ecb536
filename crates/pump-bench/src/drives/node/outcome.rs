//! The outcome of a motion: the steps that were made, as far as they are known.

use super::error::NodeError;
use crate::drives::DriveFault;

/// Fault of a motion, with the bounds of the steps made.
#[derive(Debug)]
pub(super) struct Fault {
    pub(super) error: NodeError,
    /// Fewest net steps in the plan's direction.
    pub(super) least: i64,
    /// Most net steps in the plan's direction.
    pub(super) most: i64,
}

impl Fault {
    /// Returns the number of steps made, if it is known exactly.
    pub(super) fn known(&self) -> Option<i64> {
        (self.least == self.most).then_some(self.least)
    }

    /// Returns the fault as every drive tells it.
    pub(super) fn of_drive(self) -> DriveFault {
        let Self { error, least, most } = self;
        let lost = error.loses();
        let fault = DriveFault::between(least, most, error.into());
        if lost { fault.lost() } else { fault }
    }
}
