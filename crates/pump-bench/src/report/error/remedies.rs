//! The remedies of the errors of doses, of the record and of calibrations.

use std::io;

use super::remedy::Remedy;
use crate::calibration::CalibrationError;
use crate::dosing::DoseError;
use crate::record::{FolderError, JournalError};

impl DoseError {
    /// Returns the remedies that a person has, in the order in which they are to be tried.
    pub(super) fn known_remedies(&self) -> Vec<Remedy> {
        let then = |mut first: Vec<Remedy>, last| {
            first.push(last);
            first
        };
        match self {
            Self::Folder(error) => error.known_remedies(),
            Self::Journal(error) => error.known_remedies(),
            Self::Calibration(error) => error.known_remedies(),
            Self::Unfinished { .. } => vec![Remedy::FinishOrAccept],
            Self::Unconfirmed { .. } => vec![Remedy::WriteOrConfirmPump],
            Self::RunsTheOtherWay { .. } => vec![Remedy::DropCarry],
            Self::BeyondRequest { .. } => vec![Remedy::FinishAtLowFlowOrAccept],
            Self::AngleIsKnown => vec![Remedy::FinishOrAcceptThenFindAngle],
            Self::TubeWorn { .. } => vec![Remedy::ReplaceTube],
            Self::NoRest { .. } => vec![Remedy::Accept],
            Self::NotJournalled { source, .. } | Self::NotRecorded { source, .. } => {
                then(source.known_remedies(), Remedy::ThenSeeStatus)
            }
            Self::SlowDisk { .. } => vec![Remedy::FasterDisk, Remedy::ThenSeeStatus],
            Self::Drive { unfinished: true, .. } => vec![Remedy::SeeStatusThenFinish],
            Self::Drive { unfinished: false, .. } => vec![Remedy::SeeStatus],
            Self::Retraction { source, .. } => source.known_remedies(),
            Self::AngleNotRecorded { source, .. } => source.known_remedies(),
            Self::PumpFile(_)
            | Self::Plan(_)
            | Self::Displacement(_)
            | Self::Connection(_)
            | Self::SuckBack { .. }
            | Self::Stale { .. }
            | Self::TooSlow { .. }
            | Self::NoAngle { .. }
            | Self::NoIndex { .. }
            | Self::WasFinished
            | Self::NothingUnfinished(_) => Vec::new(),
        }
    }
}

impl FolderError {
    /// Returns the remedies that a person has.
    pub(super) fn known_remedies(&self) -> Vec<Remedy> {
        match self {
            Self::Busy { .. } => Vec::new(),
            Self::File { .. } => vec![Remedy::OtherFolder],
            Self::NoFolder => vec![Remedy::NameFolder],
        }
    }
}

impl JournalError {
    /// Returns the remedies that a person has.
    pub(super) fn known_remedies(&self) -> Vec<Remedy> {
        match self {
            Self::File { source, .. } => vec![of_system(source.kind())],
            Self::Damaged { .. } => vec![Remedy::SayAngle],
            Self::Newer { .. } => Vec::new(),
        }
    }
}

/// Returns the remedy of a record that the system does not read or write.
fn of_system(kind: io::ErrorKind) -> Remedy {
    use io::ErrorKind::{FileTooLarge, PermissionDenied, QuotaExceeded, StorageFull};
    match kind {
        StorageFull | QuotaExceeded | FileTooLarge => Remedy::RoomOrOtherFolder,
        PermissionDenied => Remedy::AccessOrOtherFolder,
        _ => Remedy::OtherFolder,
    }
}

impl CalibrationError {
    /// Returns the remedies that a person has.
    pub(super) fn known_remedies(&self) -> Vec<Remedy> {
        match self {
            Self::Damaged { .. } => vec![Remedy::UseNoCalibration],
            Self::DamagedLog { .. } => vec![Remedy::BeginCalibrationAnew],
            Self::PartOfPitch { .. } => vec![Remedy::MorePitchesOrFindAngle],
            Self::OutsideSpeeds { .. } => vec![Remedy::CalibrateMoreSpeeds],
            Self::OtherPump { .. } => vec![Remedy::CalibrateAgain],
            Self::File { .. }
            | Self::Table(_)
            | Self::TooFew { .. }
            | Self::UnknownAngle { .. }
            | Self::Implausible { .. }
            | Self::FluidTemperature { .. }
            | Self::NoSpeed { .. }
            | Self::NoSuchVersion { .. }
            | Self::NoLaw { .. }
            | Self::Undetermined { .. }
            | Self::Model(_) => Vec::new(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::Explain;

    fn not_written(kind: io::ErrorKind) -> DoseError {
        let source =
            JournalError::File { action: "write", path: "journal.jsonl".into(), source: kind.into() };
        DoseError::NotJournalled { delivered_ml: 1.5, source }
    }

    #[test]
    fn the_cause_is_removed_before_anything_else() {
        let full = not_written(io::ErrorKind::StorageFull);
        assert_eq!(full.remedies(), [Remedy::RoomOrOtherFolder, Remedy::ThenSeeStatus]);
        let forbidden = not_written(io::ErrorKind::PermissionDenied);
        assert_eq!(forbidden.remedies(), [Remedy::AccessOrOtherFolder, Remedy::ThenSeeStatus]);
        let retraction = DoseError::Retraction { delivered_ml: 1.5, source: Box::new(forbidden) };
        assert_eq!(retraction.remedies(), [Remedy::AccessOrOtherFolder, Remedy::ThenSeeStatus]);
    }

    #[test]
    fn the_text_of_an_error_names_no_command() {
        let unfinished = DoseError::Unfinished { requested_ml: 25.0, least_ml: 3.0, most_ml: 4.0 };
        let worn = DoseError::TubeWorn { life_ml: 1000.0, pumped_ml: 990.0, planned_ml: 20.0 };
        let full = not_written(io::ErrorKind::StorageFull);
        for error in [unfinished, DoseError::AngleIsKnown, worn, full] {
            let text = error.to_string();
            assert!(!text.contains('`') && !text.contains("--"), "{text}");
            assert!(!error.remedies().is_empty(), "{text}");
        }
    }
}
