//! The outcome of a motion: the steps that were made, as far as they are known.

use crate::drives::DriveFault;
use crate::drives::klipper::error::KlipperError;

/// Motion that was made, or stopped.
#[derive(Debug, Clone, Copy)]
pub(in crate::drives::klipper) struct Made {
    /// Steps made.
    pub(in crate::drives::klipper) steps: u64,
    /// Step after which the index sensor became active.
    pub(in crate::drives::klipper) index_at: Option<u64>,
}

/// Motion that has ended without a fault, with the warning of its stepper driver.
pub(in crate::drives::klipper) type Ended = (Made, Option<String>);

/// Fault of a motion, with the bounds of the steps made.
#[derive(Debug)]
pub(in crate::drives::klipper) struct Fault {
    pub(in crate::drives::klipper) error: KlipperError,
    /// Fewest net steps in the plan's direction.
    pub(in crate::drives::klipper) least: u64,
    /// Most net steps in the plan's direction.
    pub(in crate::drives::klipper) most: u64,
}

impl Fault {
    /// Makes the fault of a motor that has made exactly so many steps.
    pub(in crate::drives::klipper) fn at(made: u64, error: KlipperError) -> Self {
        Self { error, least: made, most: made }
    }

    /// Returns the number of steps made, if it is known exactly.
    pub(in crate::drives::klipper) fn known(&self) -> Option<u64> {
        (self.least == self.most).then_some(self.least)
    }

    /// Returns the fault as every drive tells it.
    pub(in crate::drives::klipper) fn of_drive(self) -> DriveFault {
        let Self { error, least, most } = self;
        let signed = |steps| i64::try_from(steps).unwrap_or(i64::MAX);
        let (lost, is_reset) = (error.loses(), matches!(error, KlipperError::Reset));
        let fault = DriveFault::between(signed(least), signed(most), error.into());
        DriveFault { lost, count_lost: is_reset, ..fault }
    }
}
