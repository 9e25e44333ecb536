//! Why a dose was refused or failed.

use pump_ctl::plan::PlanError;
use thiserror::Error;

use crate::calibration::CalibrationError;
use crate::displacement::SpeedLawError;
use crate::drives::DriveError;
use crate::numbers::between;
use crate::pump_file::PumpFileError;
use crate::record::FolderError;
use crate::record::JournalError;

/// A dose that was refused or failed.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum DoseError {
    /// The pump file cannot be used.
    #[error(transparent)]
    PumpFile(#[from] PumpFileError),
    /// The dose cannot be planned.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// The folder cannot be used; nothing has moved.
    #[error(transparent)]
    Folder(#[from] FolderError),
    /// The journal cannot be used; nothing has moved.
    #[error(transparent)]
    Journal(#[from] JournalError),
    /// A calibration cannot be made or used; nothing has moved.
    #[error(transparent)]
    Calibration(#[from] CalibrationError),
    /// The pump file's speed law does not say what the dose would deliver.
    #[error(transparent)]
    SpeedLaw(#[from] SpeedLawError),
    /// An earlier dose was begun and not finished.
    #[error(
        "a dose of {requested_ml} mL is unfinished: {} were delivered; see `dose status`, then finish it with `dose resume` \
         or accept it as it is with `dose discard`",
        between(*least_ml, *most_ml)
    )]
    Unfinished {
        /// What was asked, mL.
        requested_ml: f64,
        /// Smallest volume that it may have delivered, mL.
        least_ml: f64,
        /// Largest.
        most_ml: f64,
    },
    /// What earlier doses gave too much is more than what is asked.
    #[error(
        "{asked_ml} mL asked and {carry_ml:+.4} mL carried from earlier doses would have the pump run the other way, by \
         {owed_ml:.4} mL; ask for more than what is carried, or drop it with `dose home --set`"
    )]
    RunsTheOtherWay {
        /// What is asked, mL.
        asked_ml: f64,
        /// What earlier doses owe, mL.
        carry_ml: f64,
        /// What the pump would deliver, mL.
        owed_ml: f64,
    },
    /// The dose would use up the tube.
    #[error(
        "the tube has pumped {pumped_ml:.1} mL, and this dose of {planned_ml:.4} mL would use up the {life_ml} mL that it \
         lasts; exchange the tube and say `dose tube --new`"
    )]
    TubeWorn {
        /// Volume that it lasts, mL.
        life_ml: f64,
        /// Volume that it has pumped, mL.
        pumped_ml: f64,
        /// Volume of the planned dose, either way, mL.
        planned_ml: f64,
    },
    /// The rotor has moved since the dose was prepared.
    #[error(
        "the dose was planned from {planned_deg:.4} deg, and the rotor stands at {stands_deg:.4} deg now; prepare it anew"
    )]
    Stale {
        /// Start angle of the plan, deg.
        planned_deg: f64,
        /// Angle on record, deg.
        stands_deg: f64,
    },
    /// What turns the motor cannot be used; nothing has moved.
    #[error(transparent)]
    Connection(DriveError),
    /// The device cannot turn that slowly.
    #[error(
        "the dose would peak at {speed_rpm:.4} r/min, and {driver} cannot turn slower than {least_rpm:.4} r/min \
         ({least_ml_s:.4} mL/s): it would run at that all the same; ask for that rate or more, or use fewer microsteps"
    )]
    TooSlow {
        /// Driver.
        driver: &'static str,
        /// Fastest speed of the plan, r/min.
        speed_rpm: f64,
        /// Slowest that it can, r/min, rounded up.
        least_rpm: f64,
        /// Mean flow at that, mL/s, rounded up.
        least_ml_s: f64,
    },
    /// The pump file does not say at which angle the mark or the sensor is.
    #[error("pump `{pump}` has no {key}: at which angle do {what}? say it in the pump file, in degrees")]
    NoAngle {
        /// Pump id.
        pump: String,
        /// Table and key.
        key: &'static str,
        /// What meets there.
        what: &'static str,
    },
    /// The index sensor did not answer within a revolution.
    #[error(
        "the index sensor did not answer within {turned_deg:.1} deg, in which {pumped_ml:.1} mL were pumped; look at its \
         wiring and at the disc; the turn is on record, and where the rollers stand is known as well as before"
    )]
    NoIndex {
        /// How far the rotor has turned, deg.
        turned_deg: f64,
        /// What it has pumped, mL.
        pumped_ml: f64,
    },
    /// The process that ran the dose had died, and the device has finished it since.
    #[error(
        "the device has finished the dose that was cut off: it is on record as done, and there is nothing to resume"
    )]
    WasFinished,
    /// There is no dose to resume or to discard.
    #[error("no unfinished dose is on record: there is nothing to {0}")]
    NothingUnfinished(&'static str),
    /// The motor was stopped because what it was about to do could not be written down.
    #[error(
        "the dose was stopped after {delivered_ml:.4} mL because its progress could not be recorded: {source}; make room, \
         then see `dose status`"
    )]
    NotJournalled {
        /// mL.
        delivered_ml: f64,
        /// Why.
        source: JournalError,
    },
    /// The drive failed on the way.
    #[error(
        "{error}; {} were delivered{}; see `dose status`{}",
        between(*least_ml, *most_ml),
        // Bounds mean that nobody has heard where it stands.
        if least_ml == most_ml { ", the motor holds" } else { "" },
        if *unfinished { ", then `dose resume` or `dose discard`" } else { "" }
    )]
    Drive {
        /// Why.
        error: DriveError,
        /// Smallest volume that was delivered, mL.
        least_ml: f64,
        /// Largest.
        most_ml: f64,
        /// Whether there is something to resume or to discard.
        unfinished: bool,
    },
    /// The dose is delivered and on record, but it was not sucked back.
    #[error("{delivered_ml:.4} mL were delivered and are on record, but they were not sucked back: {source}")]
    Retraction {
        /// mL.
        delivered_ml: f64,
        /// Why.
        source: Box<DoseError>,
    },
    /// The rotor was turned and its angle found, but the angle could not be recorded.
    #[error(
        "the rotor was turned and stands at {angle_deg:.4} deg, but this could not be recorded: {source}; find the angle \
         again once the journal can be written"
    )]
    AngleNotRecorded {
        /// Angle of the rotor, deg.
        angle_deg: f64,
        /// Why.
        source: JournalError,
    },
    /// The dose is over but its end could not be recorded.
    #[error(
        "{delivered_ml:.4} mL were delivered and the rotor stands at {end_angle_deg:.4} deg, but this could not be \
         recorded: {source}; make room, then see `dose status`"
    )]
    NotRecorded {
        /// mL.
        delivered_ml: f64,
        /// deg.
        end_angle_deg: f64,
        /// Why.
        source: JournalError,
    },
}

/// What an error means for the caller, by whether anything moved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ErrorClass {
    /// Nothing has moved: the request was refused.
    Refused,
    /// Nothing has moved: another process holds the pump or its device.
    Busy,
    /// Nothing has moved: an unfinished dose is on record.
    Unfinished,
    /// The motor may have turned before the error.
    Fault,
}

impl DoseError {
    /// Class of the error. Exit codes of the command follow from it.
    pub fn class(&self) -> ErrorClass {
        match self {
            Self::Drive { .. }
            | Self::NoIndex { .. }
            | Self::Retraction { .. }
            | Self::NotJournalled { .. }
            | Self::AngleNotRecorded { .. }
            | Self::NotRecorded { .. } => ErrorClass::Fault,
            Self::Folder(FolderError::Busy { .. }) | Self::Connection(DriveError::Busy { .. }) => {
                ErrorClass::Busy
            }
            Self::Unfinished { .. } => ErrorClass::Unfinished,
            Self::PumpFile(_)
            | Self::Plan(_)
            | Self::Folder(_)
            | Self::Journal(_)
            | Self::Calibration(_)
            | Self::SpeedLaw(_)
            | Self::RunsTheOtherWay { .. }
            | Self::TubeWorn { .. }
            | Self::Stale { .. }
            | Self::Connection(_)
            | Self::TooSlow { .. }
            | Self::NoAngle { .. }
            | Self::WasFinished
            | Self::NothingUnfinished(_) => ErrorClass::Refused,
        }
    }
}
