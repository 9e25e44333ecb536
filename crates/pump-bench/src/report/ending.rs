//! The ending of a command that was refused or failed, by whether anything moved.

use crate::balance::BalanceError;
use crate::dosing::DoseError;
use crate::drives::DriveError;
use crate::record::FolderError;

/// Ending of a command that did not do what was asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ending {
    /// Nothing moved.
    Refused,
    /// Nothing moved: another process holds the pump or its device.
    Busy,
    /// Nothing moved: an unfinished dose is on record.
    Unfinished,
    /// Nothing moved: the pump stands at a safety limit, or by order.
    Stands,
    /// Nothing moved: the user asked to stop.
    Stopped,
    /// The pump had begun to move.
    Moved,
}

impl DoseError {
    /// Tells how a command ends with this error.
    pub fn ending(&self) -> Ending {
        match self {
            Self::Folder(error) => error.ending(),
            Self::Connection(error) => error.ending(),
            Self::Unfinished { .. }
            | Self::UnfinishedRun { .. }
            | Self::NoRest { .. }
            | Self::NoRestByWeight(_)
            | Self::NoRestOfProfile { .. }
            | Self::BeyondRequest { .. }
            | Self::AngleIsKnown => Ending::Unfinished,
            Self::Stands { .. } => Ending::Stands,
            Self::Balance(error) => error.ending(),
            Self::ByWeight { .. }
            | Self::Drive { .. }
            | Self::NoIndex { .. }
            | Self::RanOut { .. }
            | Self::Retraction { .. }
            | Self::NotJournalled { .. }
            | Self::SlowDisk { .. }
            | Self::Panicked
            | Self::AngleNotRecorded { .. }
            | Self::NotRecorded { .. } => Ending::Moved,
            Self::PumpFile(_)
            | Self::Plan(_)
            | Self::RestWithoutAngle(_)
            | Self::DeviceSpeed { .. }
            | Self::Profile(_)
            | Self::Flow(_)
            | Self::SteepFlow { .. }
            | Self::Journal(_)
            | Self::Calibration(_)
            | Self::Displacement(_)
            | Self::Unconfirmed { .. }
            | Self::TurnedOtherwise { .. }
            | Self::NotCleared { .. }
            | Self::NotPutToStand { .. }
            | Self::Disturbed { .. }
            | Self::RunsTheOtherWay { .. }
            | Self::SuckBack { .. }
            | Self::TubeWorn { .. }
            | Self::Stale { .. }
            | Self::TooSlow { .. }
            | Self::NoAngle { .. }
            | Self::NotByWeight { .. }
            | Self::NoRun { .. }
            | Self::WasFinished
            | Self::NotUnfinished { .. }
            | Self::NothingUnfinished(_) => Ending::Refused,
        }
    }
}

impl DoseError {
    /// Returns the smallest and the largest volume, in mL, that was delivered before this error. `None` if nobody
    /// knows.
    pub fn delivered_ml(&self) -> Option<(f64, f64)> {
        match self {
            Self::Drive { least_ml, most_ml, .. } => Some((*least_ml, *most_ml)),
            Self::NotJournalled { delivered_ml, .. }
            | Self::SlowDisk { delivered_ml, .. }
            | Self::RanOut { delivered_ml, .. }
            | Self::Retraction { delivered_ml, .. }
            | Self::NotRecorded { delivered_ml, .. } => Some((*delivered_ml, *delivered_ml)),
            Self::ByWeight { turned_ml, .. } => Some((*turned_ml, *turned_ml)),
            Self::NoIndex { pumped_ml, .. } => Some((*pumped_ml, *pumped_ml)),
            Self::AngleNotRecorded { .. } | Self::Panicked => None,
            _ => Some((0.0, 0.0)),
        }
    }
}

impl FolderError {
    /// Tells how a command ends with this error.
    pub fn ending(&self) -> Ending {
        match self {
            Self::Busy { .. } => Ending::Busy,
            Self::File { .. } | Self::NoFolder => Ending::Refused,
        }
    }
}

impl DriveError {
    /// Tells how a command ends that met this error before anything moved.
    fn ending(&self) -> Ending {
        match self {
            Self::Busy { .. } => Ending::Busy,
            Self::Interrupted => Ending::Stopped,
            Self::Unable { .. }
            | Self::Device(_)
            | Self::Refused(_)
            | Self::Name { .. }
            | Self::Other { .. }
            | Self::NotGiven { .. }
            | Self::OtherDriver { .. }
            | Self::NoBoard { .. }
            | Self::NotBuilt { .. } => Ending::Refused,
        }
    }
}

impl BalanceError {
    /// Tells how a command ends that met this error before anything moved.
    pub(super) fn ending(&self) -> Ending {
        if matches!(self, Self::Stopped) { Ending::Stopped } else { Ending::Refused }
    }
}
