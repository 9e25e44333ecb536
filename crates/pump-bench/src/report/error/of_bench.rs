//! The facts of errors of doses, of the record and of drives.

use pump_model::Shown;

use super::explain::{ErrorFacts, Explain};
use super::kind::ErrorKind;
use crate::dosing::{DoseError, ScheduleError, WeightFault};
use crate::notice::Remedy;
use crate::record::{BackupError, FolderError, JournalError, LogError, MomentError};
use crate::report::ending::Ending;
use crate::safety::SafetyLimit;

impl Explain for DoseError {
    fn facts(&self) -> ErrorFacts {
        let of = ErrorFacts::of;
        let ml = |volume_ml: f64| format!("{} mL", Shown(volume_ml));
        match self {
            Self::PumpFile(error) => error.facts(),
            Self::Plan(error) | Self::RestWithoutAngle(error) => error.facts(),
            Self::Profile(error) => error.facts(),
            Self::Flow(error) | Self::SteepFlow { source: error, .. } => error.facts(),
            Self::Folder(error) => error.facts(),
            Self::Journal(error) => error.facts(),
            Self::Calibration(error) => error.facts(),
            Self::Displacement(error) => error.facts(),
            Self::Connection(error) | Self::Drive { error, .. } => error.facts(),
            Self::DeviceSpeed { source, .. } | Self::Retraction { source, .. } => source.facts(),
            Self::Balance(error) | Self::ByWeight { fault: WeightFault::Balance(error), .. } => error.facts(),
            Self::ByWeight { .. } => of(ErrorKind::Balance),
            Self::NotByWeight { volume_ml, .. } => of(ErrorKind::Range).value(ml(*volume_ml)),
            Self::Unfinished { requested_ml, .. }
            | Self::NoRest { requested_ml, .. }
            | Self::BeyondRequest { requested_ml, .. } => of(ErrorKind::Unfinished).value(ml(*requested_ml)),
            Self::UnfinishedRun { .. } | Self::NoRestByWeight(_) | Self::NoRestOfProfile { .. } => {
                of(ErrorKind::Unfinished)
            }
            Self::Stands { stand, .. } if stand.limit != SafetyLimit::Ordered => of(ErrorKind::Safety)
                .value(ml(stand.used_ml + stand.planned_ml))
                .allowed(format!("{} mL at most", Shown(stand.allowed_ml))),
            Self::Stands { .. } | Self::NotCleared { .. } | Self::NotPutToStand { .. } => {
                of(ErrorKind::Safety)
            }
            Self::RanOut { .. } => of(ErrorKind::Limit),
            Self::Disturbed { within_deg, .. } => within_deg
                .iter()
                .fold(of(ErrorKind::Angle), |facts, deg| facts.value(format!("{} deg", Shown(*deg)))),
            Self::NoRun { .. } => of(ErrorKind::Range),
            Self::RunsTheOtherWay { asked_ml, .. } => of(ErrorKind::Plan).value(ml(*asked_ml)),
            Self::TubeWorn { unit, life, used, planned } => of(ErrorKind::Limit)
                .value(format!("{:.1} {unit}", used + planned))
                .allowed(format!("{life} {unit} at most")),
            Self::Stale { planned_deg, stands_deg } => of(ErrorKind::Plan)
                .value(format!("{planned_deg:.4} deg"))
                .allowed(format!("{stands_deg:.4} deg")),
            Self::TooSlow { speed_rpm, least_rpm, .. } => of(ErrorKind::Limit)
                .value(format!("{speed_rpm:.4} r/min"))
                .allowed(format!("{least_rpm:.4} r/min or more")),
            Self::NoAngle { key, .. } => of(ErrorKind::PumpFile).value(key),
            Self::Unconfirmed { values, .. } => {
                of(ErrorKind::PumpFile).value(values).allowed("values that a person has written or confirmed")
            }
            Self::TurnedOtherwise { now, then, .. } => of(ErrorKind::PumpFile).value(now).allowed(then),
            Self::NoIndex { .. } | Self::AngleIsKnown => of(ErrorKind::Angle),
            Self::SuckBack { source, .. } => source.facts(),
            Self::NotUnfinished { dose, .. } => of(ErrorKind::Changed).value(dose),
            Self::WasFinished
            | Self::NothingUnfinished(_)
            | Self::NotJournalled { .. }
            | Self::SlowDisk { .. }
            | Self::Panicked
            | Self::AngleNotRecorded { .. }
            | Self::NotRecorded { .. } => of(ErrorKind::Record),
        }
    }

    fn ending(&self) -> Ending {
        Self::ending(self)
    }

    fn remedies(&self) -> Vec<Remedy> {
        self.known_remedies()
    }
}

impl Explain for FolderError {
    fn facts(&self) -> ErrorFacts {
        match self {
            Self::Busy { holder, .. } => ErrorFacts::of(ErrorKind::Busy).value(holder),
            Self::File { path, source, .. } => ErrorFacts::of_file(ErrorKind::Record, path, source),
            _ => ErrorFacts::of(ErrorKind::Record),
        }
    }

    fn ending(&self) -> Ending {
        Self::ending(self)
    }

    fn remedies(&self) -> Vec<Remedy> {
        self.known_remedies()
    }
}

impl Explain for JournalError {
    fn facts(&self) -> ErrorFacts {
        ErrorFacts::of(ErrorKind::Record)
    }

    fn remedies(&self) -> Vec<Remedy> {
        self.known_remedies()
    }
}

impl Explain for BackupError {
    fn facts(&self) -> ErrorFacts {
        let of = ErrorFacts::of;
        match self {
            Self::File { path, source, .. } => ErrorFacts::of_file(ErrorKind::Record, path, source),
            Self::Folder(error) => error.facts(),
            Self::Damaged { path, .. } => {
                of(ErrorKind::Input).value(path.display()).allowed("a whole backup")
            }
            Self::TurnsBack { here, there, .. } | Self::OtherHistory { here, there, .. } => {
                of(ErrorKind::Record).value(there).allowed(format!("a backup with the entry at {here}"))
            }
            Self::Differs { path, .. } => of(ErrorKind::Record).value(path.display()),
        }
    }

    fn ending(&self) -> Ending {
        match self {
            Self::Folder(error) => error.ending(),
            _ => Ending::Refused,
        }
    }
}

impl Explain for LogError {
    fn facts(&self) -> ErrorFacts {
        ErrorFacts::of_file(ErrorKind::Record, &self.path, &self.source)
    }
}

impl Explain for MomentError {
    fn facts(&self) -> ErrorFacts {
        let allowed = "a time ago as 90min, 12h, 2d or 1w, a date, or a time with its offset";
        ErrorFacts::of(ErrorKind::Quantity).value(&self.text).allowed(allowed)
    }
}

impl Explain for ScheduleError {
    fn facts(&self) -> ErrorFacts {
        match self {
            Self::OutOfRange { value, allowed, .. } => {
                ErrorFacts::of(ErrorKind::Range).value(Shown(*value)).allowed(allowed)
            }
        }
    }
}
