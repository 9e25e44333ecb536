//! A bench: one pump, what turns it, and what is recorded of it.

use std::path::Path;

use pump_ctl::plan::{Phase, PlanError};
use pump_model::Pump;
use thiserror::Error;

use crate::calibration::CalibrationError;
use crate::dose::{DoseRequest, PhaseSource, Prepared};
use crate::drivers::DriveError;
use crate::folder::{Folder, FolderError};
use crate::journal::{JournalError, State, Story};
use crate::pump_file::{DriverName, PumpFile, PumpFileError};
use crate::session::Session;
use crate::tube::TubeLife;

/// A pump with its driver and the folder of its journal.
#[derive(Debug, Clone, PartialEq)]
pub struct Bench {
    file: PumpFile,
    model: Pump,
    driver: DriverName,
    folder: Folder,
}

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
        "{error}; {} were delivered, the motor holds; see `dose status`, then `dose resume` or `dose discard`",
        between(*least_ml, *most_ml)
    )]
    Drive {
        /// Why.
        error: DriveError,
        /// Smallest volume that was delivered, mL.
        least_ml: f64,
        /// Largest.
        most_ml: f64,
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

/// A volume that is known between bounds, in words.
pub(crate) fn between(least_ml: f64, most_ml: f64) -> String {
    if most_ml - least_ml < 1e-9 {
        format!("{least_ml:.4} mL")
    } else {
        format!("between {least_ml:.4} and {most_ml:.4} mL")
    }
}

impl Bench {
    /// A bench for the pump of `file` with the driver that it names, or `driver` instead. Creates nothing yet.
    pub fn new(file: PumpFile, driver: Option<DriverName>, state_dir: &Path) -> Result<Self, DoseError> {
        file.check(&file.pump.id)?;
        let model = file.model().map_err(PlanError::from)?;
        let driver = driver.unwrap_or(file.driver());
        let folder = Folder::new(state_dir, &file.pump.id, driver.as_str());
        Ok(Self { file, model, driver, folder })
    }

    /// The pump file.
    pub fn file(&self) -> &PumpFile {
        &self.file
    }

    /// The pump's model.
    pub fn model(&self) -> &Pump {
        &self.model
    }

    /// What turns the motor.
    pub fn driver(&self) -> DriverName {
        self.driver
    }

    /// Where its journal is kept.
    pub fn folder(&self) -> &Folder {
        &self.folder
    }

    /// The state of this pump without a journal: a simulated one stands at 0 deg.
    pub(crate) fn fresh(&self) -> State {
        match self.driver {
            DriverName::Sim => State::fresh(Phase::known(0.0)),
        }
    }

    /// What its journal says.
    pub fn story(&self) -> Result<Story, DoseError> {
        Ok(self.folder.read(&self.model, self.fresh())?)
    }

    /// Plans a dose from the recorded angle and predicts it. Moves and writes nothing.
    pub fn prepare(&self, request: DoseRequest) -> Result<Prepared, DoseError> {
        self.prepare_from(self.story()?.state, request)
    }

    /// Plans a dose as if `state` were on record.
    pub(crate) fn prepare_from(
        &self,
        state: Option<State>,
        request: DoseRequest,
    ) -> Result<Prepared, DoseError> {
        let prepared = self.plan_from(state, request)?;
        self.tube_life(state, &prepared).map_or(Ok(()), |tube| tube.check())?;
        Ok(prepared)
    }

    /// The same with whatever tube there is: a dose that was begun may end on it.
    pub(crate) fn plan_from(
        &self,
        state: Option<State>,
        request: DoseRequest,
    ) -> Result<Prepared, DoseError> {
        if let Some(dose) = state.and_then(|state| state.unfinished) {
            let (least_ml, most_ml) = dose.delivered_ml(&self.model);
            return Err(DoseError::Unfinished { requested_ml: dose.intent.requested_ml, least_ml, most_ml });
        }
        let (start, source) = match (request.start_angle_rad, state) {
            (Some(angle_rad), _) => (Phase::known(angle_rad), PhaseSource::Given),
            (None, Some(state)) => (state.phase(), PhaseSource::Recorded),
            (None, None) => (self.fresh().phase(), PhaseSource::Home),
        };
        let carry_ml = state.map_or(0.0, |state| state.carry_ml);
        let mut prepared = Prepared::new(&self.file, &self.model, request, start, source, carry_ml)?;
        prepared.warnings.extend(self.tube_life(state, &prepared).and_then(|tube| tube.warning()));
        Ok(prepared)
    }

    /// None if nobody has said how long a tube lasts.
    fn tube_life(&self, state: Option<State>, prepared: &Prepared) -> Option<TubeLife> {
        Some(TubeLife {
            life_ml: self.file.tube.life_ml?,
            pumped_ml: state.map_or(0.0, |state| state.wear.volume_ml),
            planned_ml: prepared.plan.planned_ml.abs(),
        })
    }

    /// Takes the pump for this process until the session is dropped.
    pub fn session(&self) -> Result<Session<'_>, DoseError> {
        Session::open(self)
    }
}
