//! The remedies of the errors of doses, of the record and of calibrations.

use std::io;

use pump_ctl::plan::{FlowError, Nearest, PlanError};

use crate::balance::BalanceError;
use crate::calibration::CalibrationError;
use crate::dosing::{DoseError, NoRestByWeight, RunBound, WeightFault};
use crate::drives::DriveError;
use crate::notice::Remedy;
use crate::pump_file::PumpFileError;
use crate::record::{FolderError, JournalError};
use crate::safety::Stand;

/// Returns the remedies of a pump that stands.
fn of_stand(stand: &Stand) -> Vec<Remedy> {
    let first = stand.has_full_vessel().then_some(Remedy::EmptyVessel);
    first.into_iter().chain([Remedy::ClearStand]).collect()
}

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
            Self::Unfinished { .. } | Self::UnfinishedRun { .. } => vec![Remedy::FinishOrAccept],
            Self::Stands { is_recorded: true, stand, .. } => of_stand(stand),
            Self::Disturbed { .. }
            | Self::Plan(PlanError::SmoothWithoutAngle { .. } | PlanError::LowFlowWithoutAngle { .. }) => {
                vec![Remedy::FindAngle]
            }
            Self::RestWithoutAngle(error) => vec![Remedy::FindAngleOfUnfinished, rest_without_angle(error)],
            Self::Unconfirmed { .. } => vec![Remedy::WriteOrConfirmPump],
            Self::TurnedOtherwise { .. } => vec![Remedy::ConfirmTurning],
            Self::RunsTheOtherWay { .. } => vec![Remedy::DropCarry],
            Self::BeyondRequest { .. } => vec![Remedy::FinishAtLowFlowOrAccept],
            Self::AngleIsKnown => vec![Remedy::FinishOrAcceptThenFindAngle],
            Self::TubeWorn { .. } | Self::RanOut { bound: RunBound::Tube, .. } => vec![Remedy::ReplaceTube],
            Self::NoRest { .. } | Self::NoRestOfProfile { .. } => vec![Remedy::Accept],
            Self::SteepFlow { .. } => vec![Remedy::GentlerFlow],
            Self::Flow(FlowError::UnsureAngle { .. }) => vec![Remedy::SayExactAngle],
            Self::ByWeight { fault, from_stated_angle, .. } => by_weight(fault, *from_stated_angle),
            Self::NoRestByWeight(why) => vec![by_weight_again(why)],
            Self::Balance(error) => error.known_remedies(),
            Self::NotJournalled { source, .. } | Self::NotRecorded { source, .. } => {
                then(source.known_remedies(), Remedy::ThenSeeStatus)
            }
            Self::SlowDisk { .. } => vec![Remedy::FasterDisk, Remedy::ThenSeeStatus],
            Self::Panicked => vec![Remedy::SeeStatusThenFinish],
            Self::Drive { error, unfinished, over_time, .. } => of_fault(error, *unfinished, *over_time),
            Self::DeviceSpeed { source, .. } | Self::Retraction { source, .. } => source.known_remedies(),
            Self::AngleNotRecorded { source, .. } => then(source.known_remedies(), Remedy::ThenFindAngle),
            Self::PumpFile(error) => error.known_remedies(),
            Self::Connection(error) => error.known_remedies(),
            Self::SuckBack { source, .. } if breaks_at_rest(source) => Vec::new(),
            Self::SuckBack { .. } => vec![Remedy::SuckBackLess],
            Self::Plan(_)
            | Self::Profile(_)
            | Self::Flow(_)
            | Self::Displacement(_)
            | Self::Stale { .. }
            | Self::TooSlow { .. }
            | Self::NoAngle { .. }
            | Self::NoIndex { .. }
            | Self::NotByWeight { .. }
            | Self::NoRun { .. }
            | Self::Stands { .. }
            | Self::NotCleared { .. }
            | Self::NotPutToStand { .. }
            | Self::RanOut { .. }
            | Self::WasFinished
            | Self::NotUnfinished { .. }
            | Self::NothingUnfinished(_) => Vec::new(),
        }
    }
}

/// Returns the remedies of a fault in motion, which may have left a dose unfinished.
fn of_fault(error: &DriveError, unfinished: bool, over_time: bool) -> Vec<Remedy> {
    let remedies = of_stopped(error);
    let (mut remedies, last) = match (unfinished, over_time) {
        (true, true) => (while_unfinished(remedies), Remedy::Accept),
        (true, false) => (while_unfinished(remedies), Remedy::SeeStatusThenFinish),
        (false, _) => (remedies, Remedy::SeeStatus),
    };
    remedies.push(last);
    remedies
}

/// Returns the remedies of an error that has stopped a motor. The status of the pump, which comes after them, tells how
/// well the angle is known and what finds it. The wiring was right when the motor began.
fn of_stopped(error: &DriveError) -> Vec<Remedy> {
    let needless = [Remedy::FindAngleIfLost, Remedy::BridgeStop, Remedy::CheckFaultLevel];
    let mut remedies = error.known_remedies();
    remedies.retain(|remedy| !needless.contains(remedy));
    remedies
}

/// Returns the way to finish a dose without the angle that its rest needs.
fn rest_without_angle(error: &PlanError) -> Remedy {
    match error {
        PlanError::LowFlowWithoutAngle { .. } => Remedy::FinishAnywhere,
        _ => Remedy::FinishAtConstantSpeed,
    }
}

/// Returns the remedies as they are while a dose is unfinished.
fn while_unfinished(mut remedies: Vec<Remedy>) -> Vec<Remedy> {
    for remedy in remedies.iter_mut().filter(|remedy| **remedy == Remedy::FindAngle) {
        *remedy = Remedy::FindAngleOfUnfinished;
    }
    remedies
}

/// Returns the remedy of a dose by weight that has no rest by weight.
fn by_weight_again(why: &NoRestByWeight) -> Remedy {
    match why {
        NoRestByWeight::ByVolume => Remedy::FinishOrLeave,
        NoRestByWeight::NoTare => Remedy::FinishByVolumeInstead,
        NoRestByWeight::OtherLoad { .. } => Remedy::PutVesselBack,
        NoRestByWeight::Ceiling { .. } => Remedy::RaiseCeiling,
    }
}

/// Returns the remedies of a dose by weight that a fault ended.
fn by_weight(fault: &WeightFault, from_stated_angle: bool) -> Vec<Remedy> {
    let mut found = match fault {
        WeightFault::Balance(error) => error.known_remedies(),
        WeightFault::NoMotor { .. } => return vec![Remedy::NameMotor],
        fault if from_stated_angle && fault.may_be_the_angle() => vec![Remedy::RotorTurnedByHand],
        _ => Vec::new(),
    };
    found.push(Remedy::SeeStatusThenFinish);
    found
}

impl BalanceError {
    /// Returns the remedies that a person has.
    pub(super) fn known_remedies(&self) -> Vec<Remedy> {
        match self {
            Self::OtherProtocol { .. } => vec![Remedy::OtherProtocol],
            Self::Unanswered { .. } | Self::Unintelligible { .. } | Self::Refused { .. } => {
                vec![Remedy::CheckBalance]
            }
            Self::AtBoard { .. } => vec![Remedy::OtherScalePort],
            _ => Vec::new(),
        }
    }
}

/// Returns true for a plan that a limit refuses because the line breaks it at rest: then no speed helps.
fn breaks_at_rest(error: &PlanError) -> bool {
    use PlanError::{InletPressure, OutletPressure, OutletSuction};
    match error {
        OutletPressure { nearest, .. } | InletPressure { nearest, .. } | OutletSuction { nearest, .. } => {
            *nearest == Nearest::RestBreaks
        }
        _ => false,
    }
}

impl PumpFileError {
    /// Returns the remedies that a person has.
    pub(super) fn known_remedies(&self) -> Vec<Remedy> {
        match self {
            // The one fault of a port is that there is none.
            Self::Value { key: "[drive] port", .. } => vec![Remedy::PortEachTime],
            Self::Value { key: "[head] catalogue", .. } => vec![Remedy::ListHeads],
            Self::Value { key: "[head] ml_per_rev", value, .. } if value == "missing" => {
                vec![Remedy::ListHeads]
            }
            _ => Vec::new(),
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
            Self::NoLastDose | Self::UnsureLastDose { .. } => vec![Remedy::DoseThenWeigh],
            Self::LastDoseFromUnknownAngle { .. } => vec![Remedy::DoseFromKnownAngle],
            Self::WeighedOtherwise { .. } => vec![Remedy::JoinOrBeginAnew],
            Self::WeighedWith { .. } => vec![Remedy::WeighAlone],
            Self::DosedWith { .. } => vec![Remedy::NameWeighedFluid],
            Self::File { .. }
            | Self::Table(_)
            | Self::TooFew { .. }
            | Self::UnknownAngle { .. }
            | Self::Implausible { .. }
            | Self::ImplausibleReading { .. }
            | Self::UnlikelyReading { .. }
            | Self::DosedSince { .. }
            | Self::NoSuchDose { .. }
            | Self::FluidTemperature { .. }
            | Self::NoSpeed { .. }
            | Self::NoSuchVersion { .. }
            | Self::NoLaw { .. }
            | Self::Undetermined { .. }
            | Self::Fluid(_)
            | Self::Model(_) => Vec::new(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dosing::LifeUnit;
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
        let worn =
            DoseError::TubeWorn { unit: LifeUnit::Millilitres, life: 1000.0, used: 990.0, planned: 20.0 };
        let full = not_written(io::ErrorKind::StorageFull);
        for error in [unfinished, DoseError::AngleIsKnown, worn, full] {
            let text = error.to_string();
            assert!(!text.contains('`') && !text.contains("--"), "{text}");
            assert!(!error.remedies().is_empty(), "{text}");
        }
    }
}
