//! A bench: one pump, its drive, and its record.

mod calibrating;
mod head;
mod options;
mod planned_from;
mod run_volume;

pub use head::head_print;
pub(super) use head::{changes_of_file, print_of};

use std::path::Path;
use std::time::SystemTime;

use pump_ctl::plan::{Phase, PlanError};
use pump_model::Pump;
use pump_model::units::TURN_RAD;

use super::safety::RunBounds;
use super::session::Patience;
use crate::calibration::{Calibrations, Stored};
use crate::catalogue::{as_a_copy, with_own_uncertainty};
use crate::displacement::Correction;
use crate::dosing::DoseError;
use crate::dosing::TubeLife;
use crate::dosing::{DoseRequest, Prepared, RunEnd, Stands};
use crate::drives::{Drive, DriveError, Identity, Opening, SETTINGS_RECORD, registry};
use crate::notice::{Notice, Remedy};
use crate::pump_file::{DriveTable, DriverName, PumpFile};
use crate::record::Folder;
use crate::record::{Clock, SystemClock};
use crate::record::{PhaseSource, Purpose};
use crate::record::{PumpState, Story, Wear};

/// Bench of one pump: its file, its model, its drive and the folder of its journal.
#[derive(Debug, Clone, PartialEq)]
pub struct Bench {
    file: PumpFile,
    model: Pump,
    drive: DriveTable,
    identity: Identity,
    /// True if sessions are given their drive. Otherwise they open the one that the drive table names.
    is_given: bool,
    folder: Folder,
    opening: Opening,
    /// True if the angle may be found while a dose is unfinished.
    unfinished: bool,
    /// True if the user confirms the values of the pump that the program filled in.
    confirms_pump: bool,
    /// True if a person watches how the motor turns, by whatever pump file.
    turning_is_watched: bool,
    /// Patience with another process that holds the pump or its port.
    patience: Patience,
    /// True if dry runs leave the record out.
    plans_afresh: bool,
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
        let file = with_own_uncertainty(file);
        let model = file.model().map_err(PlanError::from)?;
        let driver = driver.unwrap_or(file.driver());
        let named = file.drive.clone().filter(|drive| drive.driver == driver);
        let drive = named.unwrap_or(DriveTable::of(driver));
        let identity = registry::identity(driver);
        let file = if identity.is_simulated { file } else { as_a_copy(file) };
        let folder = Folder::new(state_dir, &file.pump.id, &identity.id);
        let opening = Opening::of_pump(&file.pump.id, driver, state_dir);
        let (is_given, unfinished, confirms_pump, plans_afresh) = (false, false, false, false);
        let turning_is_watched = false;
        let patience = Patience::default();
        Ok(Self {
            file,
            model,
            drive,
            identity,
            is_given,
            folder,
            opening,
            unfinished,
            confirms_pump,
            turning_is_watched,
            patience,
            plans_afresh,
        })
    }

    /// Returns the bench of the same pump that keeps the record of `drive`. [`Session::with_drive`] takes the drive.
    ///
    /// The index angle and the hold time stay those of the pump file's `[drive]`. Its port is left out.
    ///
    /// # Errors
    ///
    /// [`DoseError::Connection`] with [`DriveError::Name`] if the drive's name cannot name a folder, or is that of
    /// another drive that pump files name.
    ///
    /// [`Session::with_drive`]: super::Session::with_drive
    pub fn driven_by(self, drive: &dyn Drive) -> Result<Self, DoseError> {
        let identity = Identity::of(drive).map_err(DoseError::Connection)?;
        let folder = self.folder.of_drive(&identity.id);
        let opening = Opening { settings_record: Some(folder.path().join(SETTINGS_RECORD)), ..self.opening };
        let table = DriveTable { port: None, ..self.file.drive.clone().unwrap_or(self.drive) };
        let file = if identity.is_simulated { self.file } else { as_a_copy(self.file) };
        Ok(Self { file, drive: table, identity, is_given: true, folder, opening, ..self })
    }

    /// Returns the patience of a session with another process.
    pub(super) fn patience(&self) -> Patience {
        self.patience.clone()
    }

    /// Returns true if the user confirms the values of the pump that the program filled in.
    pub(super) fn confirms_pump(&self) -> bool {
        self.confirms_pump
    }

    /// Returns true if the motor may be turned in another way than when it moved last.
    pub(super) fn may_turn_otherwise(&self) -> bool {
        self.is_simulated() || self.confirms_pump || self.turning_is_watched
    }

    /// Returns the pump file.
    pub fn file(&self) -> &PumpFile {
        &self.file
    }

    /// Returns the pump's model.
    pub fn model(&self) -> &Pump {
        &self.model
    }

    /// Returns the name of the drive that turns the motor.
    pub fn drive_id(&self) -> &str {
        &self.identity.id
    }

    /// Returns true if no motor moves.
    pub fn is_simulated(&self) -> bool {
        self.identity.is_simulated
    }

    /// Returns true if the board may be reset as it is met, with its other motors.
    pub fn resets_as_met(&self) -> bool {
        self.identity.abilities.resets_as_met
    }

    /// Returns the identity of the drive.
    pub(crate) fn identity(&self) -> &Identity {
        &self.identity
    }

    /// Refuses a drive other than the one whose record this bench keeps.
    pub(super) fn check_drive(&self, drive: &dyn Drive) -> Result<(), DoseError> {
        let given = Identity::of(drive).map_err(DoseError::Connection)?;
        if given == self.identity {
            return Ok(());
        }
        let bench = self.identity.id.clone();
        Err(DoseError::Connection(DriveError::Other { bench, given: given.id }))
    }

    /// Returns true if sessions are given their drive.
    pub(super) fn is_given_its_drive(&self) -> bool {
        self.is_given
    }

    /// Returns the drive table: the driver, its port and its settings.
    pub fn drive(&self) -> &DriveTable {
        &self.drive
    }

    /// Returns the port of the pump's board. A simulated motor has none.
    pub fn board_port(&self) -> Option<&Path> {
        self.drive.port.as_deref().filter(|_| !self.is_simulated())
    }

    /// Returns the terms on which the device is opened. A program opens several axes of one board with them.
    pub fn opening(&self) -> &Opening {
        &self.opening
    }

    /// Returns true if the angle may be found while a dose is unfinished.
    pub(super) fn may_home_unfinished(&self) -> bool {
        self.unfinished
    }

    /// Returns the line that is printed before a motor moves, and at the head of every report.
    pub fn headline(&self) -> String {
        let device = self.drive.port.as_ref().map(|port| port.display().to_string());
        headline(&self.file.pump.id, self.is_simulated(), device.as_deref())
    }

    /// Returns the angle that a released rotor may fall before it is caught again, in rad of the pump head.
    ///
    /// The angle is two full steps of the motor.
    pub(crate) fn fall_rad(&self) -> f64 {
        2.0 * TURN_RAD / (f64::from(self.file.motor.full_steps_per_rev) * self.file.motor.gear)
    }

    /// Returns the angle that a rotor may stand from its steps, in rad of the pump head, after its motor was stopped
    /// without a ramp and slipped by `slip_steps` at most. It may have fallen as well if it is `without_current`.
    pub(crate) fn halt_rad(&self, slip_steps: u32, without_current: bool) -> f64 {
        let fall_rad = if without_current { self.fall_rad() } else { 0.0 };
        f64::from(slip_steps) * self.file.limits().motor.step_rad() + fall_rad
    }

    /// Returns the folder of the journal.
    pub fn folder(&self) -> &Folder {
        &self.folder
    }

    /// Returns the time at which a file of the pump's record was written last: its journal, its log or its
    /// calibrations. `None` if nothing is on record.
    pub fn record_written(&self) -> Option<SystemTime> {
        last_written(self.folder.path(), 1)
    }

    /// Returns true if another process holds the pump now.
    pub fn is_held(&self) -> bool {
        self.folder.holder().is_some()
    }

    /// Returns the calibrations of the pump.
    pub fn calibrations(&self) -> Calibrations {
        Calibrations::of(&self.folder)
    }

    /// Returns the state of this pump without a journal. A simulated rotor stands at 0 deg. The angle of any
    /// other is unknown.
    pub(crate) fn fresh(&self) -> PumpState {
        let pitch_rad = self.model.pitch_rad();
        let phase = if self.is_simulated() { Phase::known(0.0) } else { Phase::unknown(pitch_rad) };
        let state = PumpState::fresh(phase, PhaseSource::Home).as_recorded(pitch_rad);
        PumpState { head: Some(head_print(&self.file)), ..state }
    }

    /// Reads the journal of the pump.
    ///
    /// # Errors
    ///
    /// [`DoseError::Journal`] if the journal cannot be read.
    pub fn story(&self) -> Result<Story, DoseError> {
        Ok(self.told(self.folder.read(&self.model, self.fresh())?))
    }

    /// Returns what the pump file has changed since the last motion on record, where a dry run reads the record.
    pub(super) fn changes_on_record(&self) -> Result<Vec<Notice>, DoseError> {
        let changes = |story: Story| changes_of_file(&self.file, &story).collect();
        if self.plans_afresh { Ok(Vec::new()) } else { self.story().map(changes) }
    }

    /// Returns what a journal tells of this pump with the motor of its file.
    pub(super) fn told(&self, story: Story) -> Story {
        story.of_steps(self.way_rad(), &self.model)
    }

    /// Returns the angle of a motor step, in rad, negative if the pump file turns the motor's direction round.
    pub(super) fn way_rad(&self) -> f64 {
        let step_rad = self.file.limits().motor.step_rad();
        if self.drive.invert { -step_rad } else { step_rad }
    }

    /// Returns the state of the pump by its journal, or its fresh state without one.
    ///
    /// # Errors
    ///
    /// [`DoseError::Journal`] if the journal cannot be read.
    pub fn stands(&self) -> Result<PumpState, DoseError> {
        Ok(self.story()?.state.unwrap_or(self.fresh()))
    }

    /// Plans a dose from the recorded angle and predicts it. Moves and writes nothing.
    ///
    /// # Errors
    ///
    /// [`DoseError`] if the dose cannot be planned or a dose is unfinished. [`DoseError::Folder`] if another
    /// process moves the pump, because nobody knows yet where it will stop.
    pub fn prepare(&self, request: DoseRequest) -> Result<Prepared, DoseError> {
        let mut prepared = self.rehearse(self.state_to_plan_from()?, request)?;
        prepared.warnings.extend(self.changes_on_record()?);
        Ok(prepared)
    }

    /// Plans a dose as if `state` were on record, and tells that the device was not asked.
    pub(super) fn rehearse(
        &self,
        state: Option<PumpState>,
        request: DoseRequest,
    ) -> Result<Prepared, DoseError> {
        let now_s = SystemClock.now().unix_s;
        let safety = self.nearest_limit(state.as_ref(), now_s, request.volume_ml < 0.0);
        if request.end == RunEnd::Stop {
            self.would_run(safety, now_s)?;
        }
        let most = RunBounds { steps: None, safety };
        let file = self.file_for_dry_run()?;
        let mut prepared = self.plan_at_some_angle(state, |state| {
            let prepared = self.prepare_from(&file, state, request, Some(most))?;
            self.would_be_safe(state.as_ref(), prepared.plan.planned_ml())?;
            Ok::<_, DoseError>(prepared)
        })?;
        prepared.warnings.extend(self.device_not_asked());
        prepared.warnings.extend(self.confirmation_missing(state.as_ref()));
        Ok(prepared)
    }

    /// Returns the warning of a dry run on a real motor.
    pub(super) fn device_not_asked(&self) -> Option<Notice> {
        let unread =
            "a dry run does not ask the device: its own speeds, acceleration and count are not known";
        (!self.is_simulated()).then(|| unread.into())
    }

    /// Plans a dose as if `state` were on record. Refuses a dose that the tube will not last for. A run until it is
    /// stopped keeps within `most`.
    pub(crate) fn prepare_from(
        &self,
        file: &PumpFile,
        state: Option<PumpState>,
        request: DoseRequest,
        most: Option<RunBounds>,
    ) -> Result<Prepared, DoseError> {
        let (asked_ml, carry_ml) = (request.volume_ml, state.map_or(0.0, |state| state.carry_ml));
        let owed_ml = asked_ml + carry_ml;
        if request.purpose == Purpose::Dose && owed_ml * asked_ml < 0.0 {
            self.refuse_unfinished(state)?;
            return Err(DoseError::RunsTheOtherWay { asked_ml, carry_ml, owed_ml });
        }
        let prepared = match request.end {
            RunEnd::Volume => self.plan_from(file, state, request, None)?,
            RunEnd::Time { time_s } => self.plan_for_time(file, state, request, time_s)?,
            RunEnd::Stop => self.plan_until_stopped(file, state, request, most)?,
        };
        self.tube_life(state, &prepared).map_or(Ok(()), |tube| tube.check())?;
        Ok(prepared)
    }

    /// Plans a dose as if `state` were on record, whatever the age of the tube: a dose that was begun may end
    /// on it.
    ///
    /// `file` is the pump file as the device allows it. `to_end_ml` is the volume to the planned end of a dose
    /// whose rest this is.
    pub(crate) fn plan_from(
        &self,
        file: &PumpFile,
        state: Option<PumpState>,
        request: DoseRequest,
        to_end_ml: Option<f64>,
    ) -> Result<Prepared, DoseError> {
        self.refuse_unfinished(state)?;
        if request.smooth && !self.identity.abilities.angle_dependent_speed {
            return Err(DoseError::Connection(DriveError::Unable {
                driver: self.drive_id().to_owned(),
                ability: "speed that follows the rollers' angle: the board plans its own ramps",
                instead: Remedy::LeaveSmoothOut,
            }));
        }
        let request = DoseRequest { ramps: self.ramps_of_drive(request.ramps)?, ..request };
        let stored = self.calibrations().active()?;
        let stands = Stands { to_end_ml, ..self.stands_for(state, &request, stored.as_ref()) };
        let mut prepared = Prepared::standing(file, &self.model, stored.as_ref(), request, stands)
            .map_err(|refused| self.told_by_device(file, refused))?;
        prepared.warnings.extend(self.tube_life(state, &prepared).and_then(|tube| tube.warning()));
        Ok(prepared)
    }

    /// Returns the place from which a dose is planned, if `state` is on record and `stored` is in use.
    pub(super) fn stands_for(
        &self,
        state: Option<PumpState>,
        request: &DoseRequest,
        stored: Option<&Stored>,
    ) -> Stands {
        let state = state.unwrap_or(self.fresh());
        let (start, source) = match request.start_angle_rad {
            Some(angle_rad) => (Phase::within(angle_rad, request.start_half_width_rad), PhaseSource::Given),
            None if !state.phase().is_known(self.model.pitch_rad()) => (state.phase(), PhaseSource::Assumed),
            None => (state.phase(), state.source),
        };
        let shape = stored.map_or(Correction::NONE, |stored| stored.calibration.shape());
        // The sum of the doses since an angle counts as long as the angle's zero and the pulse are those of before.
        let goes_on = request.purpose.changes_carry() && request.start_angle_rad.is_none();
        let account = state.account.filter(|account| goes_on && account.correction.shapes_like(&shape));
        let carry_half_width_ml = match account {
            Some(_) => state.carry_half_width_ml,
            None => state.closed(&self.model).carry_half_width_ml,
        };
        Stands { start, source, carry_ml: state.carry_ml, carry_half_width_ml, account, to_end_ml: None }
    }

    /// Refuses while a dose is unfinished, because anything else would change the rest of that dose.
    ///
    /// # Errors
    ///
    /// [`DoseError::Unfinished`], [`DoseError::UnfinishedRun`] or [`DoseError::NoRestOfProfile`] with the volumes.
    pub fn refuse_unfinished(&self, state: Option<PumpState>) -> Result<(), DoseError> {
        let Some(dose) = state.and_then(|state| state.unfinished) else { return Ok(()) };
        let (least_ml, most_ml) = dose.delivered_ml(&self.model);
        if dose.intent.terms.profile {
            return Err(DoseError::NoRestOfProfile { least_ml, most_ml });
        }
        if dose.intent.terms.until_stopped || dose.intent.purpose == Purpose::Run {
            return Err(DoseError::UnfinishedRun { least_ml, most_ml });
        }
        Err(DoseError::Unfinished { requested_ml: dose.intent.whole_requested_ml(), least_ml, most_ml })
    }

    /// Returns the life of the tube with the planned dose, by the measure of which most is used. `None` without a life.
    fn tube_life(&self, state: Option<PumpState>, prepared: &Prepared) -> Option<TubeLife> {
        let plan = &prepared.plan;
        let revolutions = plan.steps().unsigned_abs() as f64 / plan.steps_per_rev();
        let planned = Wear { volume_ml: plan.planned_ml().abs(), revolutions, motion_s: prepared.motion_s() };
        TubeLife::nearest(&self.file.tube, state.map_or(Wear::default(), |state| state.wear), planned)
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

/// Returns the time at which a file in `folder`, or in its folders down to `depth`, was written last.
fn last_written(folder: &Path, depth: u32) -> Option<SystemTime> {
    let entries = std::fs::read_dir(folder).ok()?.filter_map(Result::ok);
    let of_entry = |entry: std::fs::DirEntry| {
        let found = entry.metadata().ok()?;
        if found.is_dir() && depth > 0 {
            last_written(&entry.path(), depth - 1)
        } else {
            found.modified().ok()
        }
    };
    entries.filter_map(of_entry).max()
}
