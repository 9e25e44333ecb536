//! The outcome of a motion: the steps that were made, as far as they are known.

use crate::drives::DriveFault;
use crate::drives::node::error::NodeError;

/// Motion that was made, or stopped.
#[derive(Debug, Clone, Copy)]
pub(in crate::drives::node) struct Made {
    /// Steps made.
    pub(in crate::drives::node) steps: u64,
    /// Step at which the index sensor became active.
    pub(in crate::drives::node) index_at: Option<u64>,
}

/// Fault of a motion, with the bounds of the steps made.
#[derive(Debug)]
pub(in crate::drives::node) struct Fault {
    pub(in crate::drives::node) error: NodeError,
    /// Fewest net steps in the plan's direction.
    pub(in crate::drives::node) least: i64,
    /// Most net steps in the plan's direction.
    pub(in crate::drives::node) most: i64,
}

impl Fault {
    /// Makes the fault of a motor that has not moved.
    pub(in crate::drives::node) fn at_rest(error: NodeError) -> Self {
        Self { error, least: 0, most: 0 }
    }

    /// Returns the number of steps made, if it is known exactly.
    pub(in crate::drives::node) fn known(&self) -> Option<i64> {
        (self.least == self.most).then_some(self.least)
    }

    /// Returns the fault as every drive tells it.
    pub(in crate::drives::node) fn of_drive(self) -> DriveFault {
        let Self { error, least, most } = self;
        let (lost, is_reset) = (error.loses(), matches!(error, NodeError::Reset));
        let fault = DriveFault::between(least, most, error.into());
        DriveFault { lost, count_lost: is_reset, ..fault }
    }
}
