//! The kinds of errors of a dose that callers tell apart.

use pump_ctl::plan::PlanError;

use super::DoseError;
#[cfg(any(feature = "grbl", feature = "node", feature = "klipper"))]
use crate::drives::CommonBeginError;
use crate::drives::DriveError;
#[cfg(feature = "grbl")]
use crate::drives::GrblError;
#[cfg(feature = "klipper")]
use crate::drives::KlipperError;
#[cfg(feature = "node")]
use crate::drives::NodeError;

impl DoseError {
    /// Returns the error of the rest of a dose: a rest that needs the angle has other remedies than a new dose.
    pub(crate) fn of_rest(self) -> Self {
        match self {
            Self::Plan(
                error @ (PlanError::SmoothWithoutAngle { .. } | PlanError::LowFlowWithoutAngle { .. }),
            ) => Self::RestWithoutAngle(error),
            error => error,
        }
    }

    /// Returns true if the user asked to stop before anything moved.
    pub(crate) fn is_stop(&self) -> bool {
        matches!(self, Self::Connection(DriveError::Interrupted))
    }

    /// Returns true if an axis that was to begin together with this one was stopped or failed, and nothing moved.
    pub(crate) fn is_of_another_axis(&self) -> bool {
        match self {
            #[cfg(feature = "node")]
            Self::Connection(DriveError::Device(source))
                if matches!(source.downcast_ref(), Some(NodeError::Common(CommonBeginError::Another))) =>
            {
                true
            }
            #[cfg(feature = "grbl")]
            Self::Connection(DriveError::Device(source))
                if matches!(source.downcast_ref(), Some(GrblError::Common(CommonBeginError::Another))) =>
            {
                true
            }
            #[cfg(feature = "klipper")]
            Self::Connection(DriveError::Device(source))
                if matches!(source.downcast_ref(), Some(KlipperError::Common(CommonBeginError::Another))) =>
            {
                true
            }
            _ => false,
        }
    }
}
