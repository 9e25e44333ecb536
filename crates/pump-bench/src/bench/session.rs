//! A session: this process holds the pump and runs doses. Every stretch of a dose is on record before it
//! happens.

mod before_motion;
#[cfg(all(test, any(feature = "node", feature = "klipper")))]
mod begin_together;
mod patience;

use std::ops::ControlFlow;

use libm::ceil;
use pump_model::units::rpm;

use crate::calibration::RunLog;
use crate::dosing::{DoseError, DoseRequest, Prepared, RunEnd};
use crate::drives::{BeginPlace, Drive, DriveError};
use crate::notice::Notice;
use crate::pump_file::PumpFile;
use crate::record::{Entry, Journal, JournalError, Lock, PumpState, Storage, Unfinished, Wear, Why};

pub(super) use self::before_motion::BeforeMotion;
pub(super) use self::patience::Patience;
use super::bench::{Bench, changes_of_file};
use super::device::Device;
use super::log::SessionLog;
use super::safety::RunBounds;

/// Bench that no other process can move meanwhile.
#[derive(Debug)]
pub struct Session<'a> {
    pub(super) bench: &'a Bench,
    pub(super) journal: Journal,
    /// Last state of the pump. `None` if nothing was ever recorded and no device was met.
    pub(super) state: Option<PumpState>,
    /// True if the state is on record as the rotor's rest.
    pub(super) written: bool,
    /// True as long as nothing of the pump is on record. The board is put on record with its first entry.
    pub(super) is_fresh: bool,
    /// State before a motion that an earlier process left unended, and that motion.
    pub(super) cut_off: Option<(PumpState, Unfinished)>,
    /// Dose that the device finished after the process that ran it had ended, until something else happens.
    pub(super) finished_by_device: Option<Unfinished>,
    /// Device that turns the motor. It is opened once it is needed.
    pub(super) device: Option<Device<'a>>,
    /// Drive that the session was given and that is not connected.
    given: Option<Box<dyn Drive + 'a>>,
    /// True if the session was given its drive, so that it opens no other.
    is_given: bool,
    /// Place of the next motion among those that begin together.
    pub(super) place: Option<BeginPlace>,
    /// Function to call before the next motion that begins.
    pub(super) before_motion: Option<BeforeMotion<'a>>,
    /// Notes for the user that were not shown yet.
    pub(super) notes: Vec<Notice>,
    /// True once a note has said that the clock is behind the record.
    pub(super) told_of_clock: bool,
    /// True if the angle may be found while a dose is unfinished.
    pub(super) may_home_unfinished: bool,
    /// True if this session has turned the motor.
    pub(super) moved: bool,
    /// Log of the doses.
    pub(super) log: SessionLog,
    /// Patience that is left with another process.
    pub(super) patience: Patience,
    _lock: Lock,
}

/// Result of replacing the tube.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct NewTube {
    /// State of the pump now.
    pub state: PumpState,
    /// Volume that the old tube pumped, in mL.
    pub worn_ml: f64,
    /// Carry that was dropped, in mL.
    pub owed_ml: f64,
    /// Calibration of the old tube, which is no longer used.
    pub unused: Option<u32>,
    /// Readings of a guided calibration of the old tube, which are given up.
    pub readings: usize,
}

/// Unfinished dose that was accepted as it is.
#[derive(Debug)]
pub struct Accepted {
    /// Dose, with the steps that were made.
    pub dose: Unfinished,
    /// Carry that was dropped, in mL.
    pub dropped_ml: f64,
    /// State of the pump now.
    pub state: PumpState,
    /// Error of a device that could not tell its count. `None` if it was asked.
    pub unasked: Option<DoseError>,
}

impl Bench {
    /// Takes the pump for this process until the session is dropped.
    ///
    /// # Errors
    ///
    /// [`DoseError::Folder`] if another process holds the pump. [`DoseError::Journal`] if the journal cannot
    /// be read.
    pub fn session(&self) -> Result<Session<'_>, DoseError> {
        Session::open(self)
    }
}

impl<'a> Session<'a> {
    pub(crate) fn open(bench: &'a Bench) -> Result<Self, DoseError> {
        let mut patience = bench.patience();
        let lock = patience.try_until(&bench.opening().stop, || Ok(bench.folder().lock()?))?;
        let (journal, story) = lock.journal(bench.model(), bench.fresh())?;
        let (log, note) = SessionLog::open(bench.folder(), &story);
        let story = bench.told(story);
        Ok(Self {
            bench,
            journal,
            state: story.state,
            is_fresh: story.state.is_none(),
            written: story.cut_off.is_none() && log.unlogged.is_none(),
            cut_off: story.cut_off,
            finished_by_device: None,
            device: None,
            given: None,
            is_given: bench.is_given_its_drive(),
            place: None,
            before_motion: None,
            notes: note.into_iter().chain(changes_of_file(bench.file(), &story)).collect(),
            told_of_clock: false,
            may_home_unfinished: bench.may_home_unfinished(),
            moved: false,
            log,
            patience,
            _lock: lock,
        })
    }

    /// Takes the pump for this process until the session is dropped, and `drive` to turn it. The drive is asked
    /// once it is needed.
    ///
    /// [`Bench::driven_by`] makes the bench of a drive, whose record is its own. A drive that fails is kept: the next
    /// motion connects it again by [`Drive::connect`] and compares its count with the record.
    ///
    /// # Errors
    ///
    /// [`DoseError::Connection`] with [`DriveError::Other`] if the bench keeps
    /// the record of another drive. Otherwise as for [`Bench::session`].
    pub fn with_drive(bench: &'a Bench, drive: Box<dyn Drive + 'a>) -> Result<Self, DoseError> {
        bench.check_drive(drive.as_ref())?;
        let mut session = Self::open(bench)?;
        session.give(Some(drive));
        Ok(session)
    }

    /// Gives the session its drive, if there is one. It opens no other from then on.
    pub(super) fn give(&mut self, drive: Option<Box<dyn Drive + 'a>>) {
        self.is_given |= drive.is_some();
        self.given = drive;
    }

    /// Returns the drive that the session was given and that is not connected. `None` if the session opens its own.
    ///
    /// # Errors
    ///
    /// [`DriveError::NotGiven`] if the session was to be given a drive.
    pub(super) fn given(&mut self) -> Result<Option<Box<dyn Drive + 'a>>, DriveError> {
        match self.given.take() {
            None if self.is_given => Err(DriveError::NotGiven { id: self.bench.drive_id().to_owned() }),
            given => Ok(given),
        }
    }

    /// Keeps a drive that is to be met anew before it moves again, if the session was given it.
    pub(super) fn put_away(&mut self, drive: Box<dyn Drive + 'a>) {
        self.given = Some(drive).filter(|_| self.is_given);
    }

    /// Has the next motion begin with those of the other places of a [`CommonBegin`]. Each session has a thread of its
    /// own, since a motion waits for the others until its begin.
    ///
    /// If a motion fails or is stopped while they wait for each other, none begins. A session that fails before its
    /// motion gives its place up, and so does one that is dropped. Several boards, and the motors of a Klipper
    /// board, are told their begin 0.2 s ahead: a motion that fails or is stopped in that time leaves its dose
    /// unfinished, and the others begin.
    ///
    /// ```
    /// use std::time::Duration;
    ///
    /// use pump_bench::drives::CommonBegin;
    /// use pump_bench::{Bench, DoseError, built_in};
    ///
    /// let state = tempfile::tempdir()?;
    /// let bench = Bench::new(built_in("three-roller").unwrap(), None, state.path())?;
    /// let place = CommonBegin::places(1, Duration::from_secs(5)).remove(0);
    /// // The simulated pump has no board to share.
    /// assert!(matches!(bench.session()?.begin_with(place), Err(DoseError::Connection(_))));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`DoseError::Connection`] if the drive cannot begin with others. The place is given up.
    ///
    /// [`CommonBegin`]: crate::drives::CommonBegin
    pub fn begin_with(&mut self, place: BeginPlace) -> Result<(), DoseError> {
        if self.bench.identity().abilities.together.is_none() {
            return Err(DoseError::Connection(DriveError::no_common_begin(self.bench.drive_id())));
        }
        self.place = Some(place);
        Ok(())
    }

    /// Has `tell` called once, just before the next motion begins. By then the device has taken the plan and every
    /// check has passed, so no refusal comes after it. When `tell` breaks, nothing moves, and nothing is left
    /// unfinished: the motion ends with [`DriveError::Interrupted`].
    ///
    /// ```
    /// use std::ops::ControlFlow;
    ///
    /// use pump_bench::{Bench, DoseRequest, built_in};
    ///
    /// let state = tempfile::tempdir()?;
    /// let bench = Bench::new(built_in("three-roller").unwrap(), None, state.path())?;
    /// let mut session = bench.session()?;
    /// let prepared = session.prepare(DoseRequest::dose(0.1))?;
    /// session.before_motion(|| ControlFlow::Break(()));
    /// assert!(session.run(&prepared, |_steps| ControlFlow::Continue(())).is_err());
    /// assert!(!session.has_moved());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn before_motion(&mut self, tell: impl FnOnce() -> ControlFlow<()> + Send + 'a) {
        self.before_motion = Some(BeforeMotion::new(tell));
    }

    /// Returns the bench of this session.
    pub fn bench(&self) -> &'a Bench {
        self.bench
    }

    /// Returns true if this session has turned the motor.
    pub fn has_moved(&self) -> bool {
        self.moved
    }

    /// Returns the state of the pump. `None` if nothing was ever recorded and no device was met.
    pub fn state(&self) -> Option<&PumpState> {
        self.state.as_ref()
    }

    /// Has the journal's entries synced by `storage`, in place of the disk itself.
    pub fn store_by(&mut self, storage: Box<dyn Storage>) {
        self.journal.store_by(storage);
    }

    /// Returns the carry to the next dose, in mL.
    pub fn owed_ml(&self) -> f64 {
        self.stands().carry_ml
    }

    /// Returns the state of the pump, or its fresh state if nothing was ever recorded.
    pub(super) fn stands(&self) -> PumpState {
        self.state.unwrap_or(self.bench.fresh())
    }

    /// Plans a dose from the recorded angle, within the limits of the device, and predicts it. Moves nothing.
    ///
    /// # Errors
    ///
    /// [`DoseError`] if a dose is unfinished, the device cannot be used, or the dose cannot be planned.
    pub fn prepare(&mut self, request: DoseRequest) -> Result<Prepared, DoseError> {
        self.check_stand()?;
        if self.cut_off.is_none() {
            self.finished()?;
        }
        self.check_confirmed()?;
        let (bench, safety) = (self.bench, self.nearest_limit(request.volume_ml < 0.0));
        let by_record = |file: &PumpFile, state| {
            bench.prepare_from(file, state, request, Some(RunBounds { steps: None, safety }))
        };
        if let Err(error) = self.connect_for(by_record) {
            if !error.is_stop() {
                self.finished()?;
            }
            return Err(error);
        }
        if request.end == RunEnd::Stop {
            self.keep_run_safe(request.volume_ml < 0.0)?;
        }
        let most_steps = self.device.as_ref().and_then(|device| device.most_steps(request.volume_ml < 0.0));
        let most = RunBounds { steps: most_steps, safety: self.nearest_limit(request.volume_ml < 0.0) };
        let prepared = self.bench.prepare_from(self.file(), self.state, request, Some(most))?;
        self.keep_safe(prepared.plan.planned_ml())?;
        self.checked(prepared)
    }

    /// Refuses a dose that the device would run in another way, and adds the notes of the device.
    pub(super) fn checked(&mut self, mut prepared: Prepared) -> Result<Prepared, DoseError> {
        let Some(device) = &self.device else { return Ok(prepared) };
        let speed_rad_s = prepared.plan.profile().peak_rad_s();
        let least_rad_s = device.least_rad_s();
        if speed_rad_s < least_rad_s {
            let up = |x: f64| ceil(1e4 * x) / 1e4;
            return Err(DoseError::TooSlow {
                driver: self.bench.drive_id().to_owned(),
                speed_rpm: rpm(speed_rad_s),
                least_rpm: up(rpm(least_rad_s)),
                least_ml_s: up(prepared.model.average_flow_ml_s(least_rad_s)),
            });
        }
        prepared.warnings.append(&mut self.notes);
        Ok(prepared)
    }

    /// Accepts the unfinished dose. The carry is zero afterwards.
    ///
    /// Returns the state, and the error if the device could not tell its count.
    ///
    /// # Errors
    ///
    /// [`DoseError::NothingUnfinished`] if no dose is unfinished. [`DoseError::Connection`] if the user asked
    /// to stop meanwhile. [`DoseError::Journal`] if the state cannot be recorded.
    pub fn discard(&mut self) -> Result<(PumpState, Option<DoseError>), DoseError> {
        self.accept().map(|accepted| (accepted.state, accepted.unasked))
    }

    /// Accepts the unfinished dose, as [`Self::discard`] does, and tells what it was.
    ///
    /// # Errors
    ///
    /// [`DoseError`] as for [`Self::discard`].
    pub fn accept(&mut self) -> Result<Accepted, DoseError> {
        self.accept_if(|_| true)
    }

    /// Accepts the unfinished dose, as [`Self::accept`] does, but not while a device that may know its exact steps
    /// cannot be asked: the bounds of a dose that is accepted stay on record for ever.
    ///
    /// # Errors
    ///
    /// [`DoseError`] as for [`Self::discard`]. [`DoseError::Connection`] if the device cannot be asked.
    pub fn accept_counted(&mut self) -> Result<Accepted, DoseError> {
        let before = self
            .cut_off
            .map_or(self.stands().unfinished.and_then(|dose| dose.count_before), |(before, _)| before.count);
        self.accept_if(|dose| dose.made_least == dose.made_most || before.is_none())
    }

    /// Accepts the unfinished dose. If the device cannot tell its count, `without_count` says whether the bounds on
    /// record will do.
    fn accept_if(&mut self, without_count: impl Fn(&Unfinished) -> bool) -> Result<Accepted, DoseError> {
        let before = self.stands();
        let begun = before.unfinished.ok_or(DoseError::NothingUnfinished("accept"))?;
        // A device that still knows its count tells the steps made. Otherwise the recorded bounds stay, and
        // the count starts anew when the device is met again.
        let unasked = match self.connect() {
            Err(error) if error.is_stop() || !without_count(&begun) => return Err(error),
            asked => asked.err(),
        };
        let state = self.stands();
        let count = state.count.filter(|_| unasked.is_none());
        // A dose that the device has finished since is unfinished no more.
        let all = begun.intent.steps.abs();
        let dose = state.unfinished.unwrap_or(Unfinished { made_least: all, made_most: all, ..begun });
        let state = PumpState { unfinished: None, count, ..state.without_carry() };
        self.rest(Why::Discarded, state)?;
        Ok(Accepted { dose, dropped_ml: before.carry_ml, state, unasked })
    }

    /// Records that the tube is new. The carry is zero afterwards, and no calibration is used.
    ///
    /// # Errors
    ///
    /// [`DoseError`] if a dose is unfinished, or the calibrations or the state cannot be written.
    pub fn new_tube(&mut self) -> Result<NewTube, DoseError> {
        // A device that still knows its count tells the steps of a run that was cut off. Otherwise the recorded
        // bounds stay, and the count starts anew when the device is met again.
        let is_cut_off = self.cut_off.is_some() && self.finished().is_ok();
        let unasked = match if is_cut_off { self.connect() } else { Ok(()) } {
            Err(error) if error.is_stop() => return Err(error),
            asked => asked.is_err(),
        };
        let before = self.finished()?;
        let count = before.count.filter(|_| !unasked);
        // Calibrations come first, so that no dose of the new tube uses the old tube's calibration.
        let calibrations = self.bench.calibrations();
        let unused = calibrations.active_version()?;
        calibrations.activate(None)?;
        let tubes_before = before.tubes_before.saturating_add(1);
        let state =
            PumpState { wear: Wear::default(), last: None, count, tubes_before, ..before.without_carry() };
        self.rest(Why::NewTube, state)?;
        // Readings of the old tube tell nothing about the new one.
        let log = RunLog::of(self.bench.folder());
        let readings = log.read().ok().flatten().map_or(0, |unfinished| unfinished.runs.len());
        log.end()?;
        Ok(NewTube { state, worn_ml: before.wear.volume_ml, owed_ml: before.carry_ml, unused, readings })
    }

    /// Returns the state of the pump.
    ///
    /// # Errors
    ///
    /// [`DoseError::Unfinished`] if a dose is unfinished.
    pub(crate) fn finished(&self) -> Result<PumpState, DoseError> {
        let state = self.stands();
        self.bench.refuse_unfinished(Some(state))?;
        Ok(state)
    }

    /// Records that the rotor stands. If that cannot be written, this session still knows it, and the next
    /// motion records it first.
    pub(super) fn rest(&mut self, why: Why, state: PumpState) -> Result<(), JournalError> {
        self.rest_because(why, state, None)
    }

    /// Records that the rotor stands, with the reason of a person.
    pub(super) fn rest_because(
        &mut self,
        why: Why,
        state: PumpState,
        reason: Option<String>,
    ) -> Result<(), JournalError> {
        let now_s = self.log.clock.now().unix_s;
        let safety = state.safety.unwrap_or_else(|| self.stands().safety_at(now_s));
        let state = PumpState { safety: Some(safety), ..state };
        let dose = self.ended_dose(why, &state);
        let state = PumpState { doses: dose.as_ref().map_or(self.log.doses, |dose| dose.number), ..state };
        self.state = Some(state);
        self.cut_off = None;
        self.finished_by_device = None;
        self.written = false;
        // A dose that cannot be recorded now is recorded with the next rest.
        self.log.ended = dose.clone();
        self.journal.append(&Entry::Rest { unix_s: now_s, why, state, dose: dose.clone(), reason })?;
        (self.written, self.is_fresh) = (true, false);
        self.device.iter_mut().for_each(|device| device.drive.recorded());
        self.log.ended = None;
        self.log.doses = state.doses;
        let unlogged = dose.and_then(|dose| self.log.copy(&dose));
        self.notes.extend(unlogged);
        Ok(())
    }
}
