//! A bench: one pump, its drive, and its record.

use std::path::{Path, PathBuf};

use pump_ctl::plan::{Phase, PlanError};
use pump_model::Pump;
use pump_model::math::TURN_RAD;

use crate::calibration::{Calibration, Calibrations, Stored};
use crate::dosing::DoseError;
use crate::dosing::TubeLife;
use crate::dosing::{DoseRequest, Prepared};
use crate::drives::{DriveError, registry};
use crate::pump_file::{DriveTable, DriverName, PumpFile};
use crate::record::Folder;
use crate::record::{PhaseSource, Purpose};
use crate::record::{State, Story};

/// Bench of one pump: its file, its model, its drive and the folder of its journal.
#[derive(Debug, Clone, PartialEq)]
pub struct Bench {
    file: PumpFile,
    model: Pump,
    drive: DriveTable,
    folder: Folder,
    /// True if the settings of the device may be written.
    configure: bool,
}

impl Bench {
    /// Sets up a bench for the pump of `file` with the driver that the file names, or `driver` instead.
    /// Creates nothing yet.
    ///
    /// # Errors
    ///
    /// [`DoseError::PumpFile`] or [`DoseError::Plan`] if the pump file or its model cannot be used.
    pub fn new(file: PumpFile, driver: Option<DriverName>, state_dir: &Path) -> Result<Self, DoseError> {
        file.check(&file.pump.id)?;
        let model = file.model().map_err(PlanError::from)?;
        let driver = driver.unwrap_or(file.driver());
        let named = file.drive.clone().filter(|drive| drive.driver == driver);
        let drive = named.unwrap_or(DriveTable::of(driver));
        let folder = Folder::new(state_dir, &file.pump.id, driver.as_str());
        Ok(Self { file, model, drive, folder, configure: false })
    }

    /// Returns the bench with its device at `port`, if a port is given. A driver that needs a port refuses to
    /// open without one.
    #[must_use]
    pub fn at_port(mut self, port: Option<PathBuf>) -> Self {
        self.drive.port = port.or(self.drive.port);
        self
    }

    /// Returns the bench with or without leave to write device settings that do not fit the pump.
    #[must_use]
    pub fn configuring(self, configure: bool) -> Self {
        Self { configure, ..self }
    }

    /// Returns the pump file.
    pub fn file(&self) -> &PumpFile {
        &self.file
    }

    /// Returns the pump's model.
    pub fn model(&self) -> &Pump {
        &self.model
    }

    /// Returns the driver that turns the motor.
    pub fn driver(&self) -> DriverName {
        self.drive.driver
    }

    /// Returns the drive table: the driver, its port and its settings.
    pub fn drive(&self) -> &DriveTable {
        &self.drive
    }

    /// Returns true if the settings of the device may be written.
    pub(crate) fn may_configure(&self) -> bool {
        self.configure
    }

    /// Returns the line that is printed before a motor moves, and at the head of every report.
    pub fn headline(&self) -> String {
        let device = self.drive.port.as_ref().map(|port| port.display().to_string());
        headline(&self.file.pump.id, self.driver() == DriverName::Sim, device.as_deref())
    }

    /// Returns the angle that a released rotor may fall before it is caught again, in rad of the pump head.
    ///
    /// The angle is two full steps of the motor.
    pub(crate) fn fall_rad(&self) -> f64 {
        2.0 * TURN_RAD / (f64::from(self.file.motor.full_steps_per_rev) * self.file.motor.gear)
    }

    /// Returns the folder of the journal.
    pub fn folder(&self) -> &Folder {
        &self.folder
    }

    /// Returns the calibrations of the pump.
    pub fn calibrations(&self) -> Calibrations {
        Calibrations::of(&self.folder)
    }

    /// Returns the state of this pump without a journal. A simulated rotor stands at 0 deg. The angle of any
    /// other is unknown.
    pub(crate) fn fresh(&self) -> State {
        let phase = registry::fresh(self.driver(), self.model.pitch_rad());
        State::fresh(phase, PhaseSource::Home)
    }

    /// Reads the journal of the pump.
    ///
    /// # Errors
    ///
    /// [`DoseError::Journal`] if the journal cannot be read.
    pub fn story(&self) -> Result<Story, DoseError> {
        Ok(self.folder.read(&self.model, self.fresh())?)
    }

    /// Returns the state of the pump by its journal, or its fresh state without one.
    ///
    /// # Errors
    ///
    /// [`DoseError::Journal`] if the journal cannot be read.
    pub fn stands(&self) -> Result<State, DoseError> {
        Ok(self.story()?.state.unwrap_or(self.fresh()))
    }

    /// Plans a dose from the recorded angle and predicts it. Moves and writes nothing.
    ///
    /// # Errors
    ///
    /// [`DoseError`] if the dose cannot be planned or a dose is unfinished. [`DoseError::Folder`] if another
    /// process moves the pump, because nobody knows yet where it will stop.
    pub fn prepare(&self, request: DoseRequest) -> Result<Prepared, DoseError> {
        let state = self.story()?.state;
        if state.is_some_and(|state| state.unfinished.is_some())
            && let Some(holder) = self.folder.holder()
        {
            return Err(self.folder.busy(holder).into());
        }
        let mut prepared = self.prepare_from(&self.file, state, request)?;
        if self.driver() != DriverName::Sim {
            let unread =
                "a dry run does not ask the device: its own speeds, acceleration and count are not known";
            prepared.warnings.push(unread.to_owned());
        }
        Ok(prepared)
    }

    /// Plans a dose as if `state` were on record. Refuses a dose that the tube will not last for.
    pub(crate) fn prepare_from(
        &self,
        file: &PumpFile,
        state: Option<State>,
        request: DoseRequest,
    ) -> Result<Prepared, DoseError> {
        let (asked_ml, carry_ml) = (request.volume_ml, state.map_or(0.0, |state| state.carry_ml));
        let owed_ml = asked_ml + carry_ml;
        if request.purpose == Purpose::Dose && owed_ml * asked_ml < 0.0 {
            self.refuse_unfinished(state)?;
            return Err(DoseError::RunsTheOtherWay { asked_ml, carry_ml, owed_ml });
        }
        let prepared = self.plan_from(file, state, request)?;
        self.tube_life(state, &prepared).map_or(Ok(()), |tube| tube.check())?;
        Ok(prepared)
    }

    /// Plans a dose as if `state` were on record, whatever the age of the tube: a dose that was begun may end
    /// on it.
    ///
    /// `file` is the pump file as the device allows it.
    pub(crate) fn plan_from(
        &self,
        file: &PumpFile,
        state: Option<State>,
        request: DoseRequest,
    ) -> Result<Prepared, DoseError> {
        self.refuse_unfinished(state)?;
        if request.smooth && !registry::abilities(self.driver()).angle_dependent_speed {
            return Err(DoseError::Connection(DriveError::Unable {
                driver: self.driver().as_str(),
                ability: "speed that follows the rollers' angle: the board plans its own ramps",
                instead: "leave --smooth out",
            }));
        }
        let stands = state.unwrap_or(self.fresh());
        let (start, source) = match request.start_angle_rad {
            Some(angle_rad) => (Phase::known(angle_rad), PhaseSource::Given),
            None if !stands.phase().is_known(self.model.pitch_rad()) => {
                (stands.phase(), PhaseSource::Assumed)
            }
            None => (stands.phase(), stands.source),
        };
        let carry_ml = state.map_or(0.0, |state| state.carry_ml);
        let stored = self.calibrations().active()?.filter(|_| request.purpose != Purpose::Calibrate);
        let mut prepared = match stored {
            Some(stored) => {
                Prepared::calibrated(file, &self.model, &stored, request, start, source, carry_ml)?
            }
            None => Prepared::new(file, &self.model, request, start, source, carry_ml)?,
        };
        prepared.warnings.extend(self.tube_life(state, &prepared).and_then(|tube| tube.warning()));
        Ok(prepared)
    }

    /// Refuses while a dose is unfinished, because anything else would change the rest of that dose.
    pub(crate) fn refuse_unfinished(&self, state: Option<State>) -> Result<(), DoseError> {
        let Some(dose) = state.and_then(|state| state.unfinished) else { return Ok(()) };
        let (least_ml, most_ml) = dose.delivered_ml(&self.model);
        Err(DoseError::Unfinished { requested_ml: dose.intent.requested_ml, least_ml, most_ml })
    }

    /// Makes doses use a calibration from now on, or none.
    ///
    /// # Errors
    ///
    /// [`DoseError`] while a dose is unfinished, because its rest would change, or if the calibration cannot
    /// be used.
    pub fn use_calibration(&self, version: Option<u32>) -> Result<(), DoseError> {
        self.refuse_unfinished(self.story()?.state)?;
        Ok(self.calibrations().activate(version)?)
    }

    /// Keeps a calibration and makes doses use it from now on. The caller must hold the pump's lock.
    ///
    /// # Errors
    ///
    /// [`DoseError`] as in [`Self::use_calibration`], or if the calibration cannot be written.
    pub fn keep_calibration(&self, calibration: Calibration) -> Result<Stored, DoseError> {
        self.refuse_unfinished(self.story()?.state)?;
        let version = self.calibrations().add(&calibration)?;
        self.use_calibration(Some(version))?;
        Ok(Stored { version, calibration })
    }

    /// Returns the life of the tube with the planned dose. `None` if the pump file gives no life.
    fn tube_life(&self, state: Option<State>, prepared: &Prepared) -> Option<TubeLife> {
        Some(TubeLife {
            life_ml: self.file.tube.life_ml?,
            pumped_ml: state.map_or(0.0, |state| state.wear.volume_ml),
            planned_ml: prepared.plan.planned_ml.abs(),
        })
    }
}

/// Returns the first line of a report: it says if a motor moves.
pub(crate) fn headline(pump: &str, simulated: bool, device: Option<&str>) -> String {
    match device {
        _ if simulated => "SIMULATED: no motor moved".to_owned(),
        Some(device) => format!("MOVING {pump} on {device}"),
        None => format!("MOVING {pump}"),
    }
}
