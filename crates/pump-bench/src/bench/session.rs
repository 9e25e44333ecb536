//! A session: this process holds the pump and runs doses. Every stretch of a dose is on record before it
//! happens.

use std::time::{SystemTime, UNIX_EPOCH};

use pump_model::math::{ceil, rpm};

use crate::calibration::RunLog;
use crate::dosing::{DoseError, DoseRequest, Prepared};
use crate::numbers::{between, significant};
use crate::record::{Entry, Journal, JournalError, Lock, Purpose, State, Unfinished, Wear, Why};

use super::bench::Bench;
use super::device::Device;

/// Bench that no other process can move meanwhile.
#[derive(Debug)]
pub struct Session<'a> {
    pub(super) bench: &'a Bench,
    pub(super) journal: Journal,
    /// Last state of the pump. `None` if nothing was ever recorded.
    pub(super) state: Option<State>,
    /// True if the state is on record as the rotor's rest.
    pub(super) written: bool,
    /// State before a motion that an earlier process left unended, and that motion.
    pub(super) cut_off: Option<(State, Unfinished)>,
    /// Device that turns the motor. It is opened once it is needed.
    pub(super) device: Option<Device<'a>>,
    /// True if this session has turned the motor.
    pub(super) moved: bool,
    _lock: Lock,
}

/// Result of replacing the tube.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NewTube {
    /// State of the pump now.
    pub state: State,
    /// Volume that the old tube pumped, in mL.
    pub worn_ml: f64,
    /// Carry that was dropped, in mL.
    pub owed_ml: f64,
    /// Calibration of the old tube, which is no longer used.
    pub unused: Option<u32>,
    /// Readings of a guided calibration of the old tube, which are given up.
    pub readings: usize,
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
        let lock = bench.folder().lock()?;
        let (journal, story) = lock.journal(bench.model(), bench.fresh())?;
        Ok(Self {
            bench,
            journal,
            state: story.state,
            written: story.cut_off.is_none(),
            cut_off: story.cut_off,
            device: None,
            moved: false,
            _lock: lock,
        })
    }

    /// Returns true if this session has turned the motor.
    pub fn has_moved(&self) -> bool {
        self.moved
    }

    /// Returns the state of the pump. `None` if nothing was ever recorded.
    pub fn state(&self) -> Option<&State> {
        self.state.as_ref()
    }

    /// Returns the carry to the next dose, in mL.
    pub fn owed_ml(&self) -> f64 {
        self.stands().carry_ml
    }

    /// Returns the state of the pump, or its fresh state if nothing was ever recorded.
    pub(super) fn stands(&self) -> State {
        self.state.unwrap_or(self.bench.fresh())
    }

    /// Plans a dose from the recorded angle, within the limits of the device, and predicts it. Moves nothing.
    ///
    /// # Errors
    ///
    /// [`DoseError`] if a dose is unfinished, the device cannot be used, or the dose cannot be planned.
    pub fn prepare(&mut self, request: DoseRequest) -> Result<Prepared, DoseError> {
        if self.cut_off.is_none() {
            self.finished()?;
        }
        if let Err(error) = self.connect() {
            self.finished()?;
            return Err(error);
        }
        let prepared = self.bench.prepare_from(self.file(), self.state, request)?;
        self.checked(prepared)
    }

    /// Plans the rest of the unfinished dose on the terms of the whole dose, in what `request` leaves open:
    /// cruise and limits. A smooth flow stays smooth, and an end at low flow stays one.
    ///
    /// The rest leads to the same end angle if the delivered volume is known, and to the most probable one
    /// otherwise.
    ///
    /// # Errors
    ///
    /// [`DoseError::NothingUnfinished`] if no dose is unfinished. [`DoseError::WasFinished`] if the device
    /// has finished the dose since. Other [`DoseError`]s if the device cannot be used or the rest cannot be
    /// planned.
    pub fn prepare_rest(&mut self, request: DoseRequest) -> Result<Prepared, DoseError> {
        if self.stands().unfinished.is_none() {
            return Err(DoseError::NothingUnfinished("resume"));
        }
        self.connect()?;
        let state = self.stands();
        let Some(dose) = state.unfinished else {
            return Err(DoseError::WasFinished);
        };
        let (least_ml, most_ml) = dose.delivered_ml(self.bench.model());
        let intent = dose.intent;
        let volume_ml = intent.requested_ml - 0.5 * (least_ml + most_ml);
        let carry_ml = if intent.purpose == Purpose::Dose { intent.carry_in_ml } else { state.carry_ml };
        let retract_ml = intent.retract_ml;
        let whole_ml = Some(intent.requested_ml);
        let request = request.for_rest(&intent.terms);
        let rest = DoseRequest { purpose: intent.purpose, volume_ml, whole_ml, retract_ml, ..request };
        let state = State { unfinished: None, carry_ml, ..state };
        let mut prepared = self.bench.plan_from(self.file(), Some(state), rest)?;
        if most_ml - least_ml > prepared.plan.end_step_ml(&prepared.model) {
            let rest_ml = prepared.plan.planned_ml;
            prepared.warnings.push(format!(
                "{} of the {} mL asked for were delivered before; this rest is for the middle of that \
                 range, so that {} will be delivered in all; `dose discard` accepts the dose as it is \
                 instead",
                between(least_ml, most_ml),
                significant(intent.requested_ml, 6),
                between(least_ml + rest_ml, most_ml + rest_ml),
            ));
        }
        self.checked(prepared)
    }

    /// Refuses a dose that the device would run in another way, and adds the notes of the device.
    fn checked(&mut self, mut prepared: Prepared) -> Result<Prepared, DoseError> {
        let Some(device) = &mut self.device else { return Ok(prepared) };
        let speed_rad_s = prepared.plan.profile.peak_rad_s();
        let least_rad_s = device.least_rad_s();
        if speed_rad_s < least_rad_s {
            let up = |x: f64| ceil(1e4 * x) / 1e4;
            return Err(DoseError::TooSlow {
                driver: self.bench.driver().as_str(),
                speed_rpm: rpm(speed_rad_s),
                least_rpm: up(rpm(least_rad_s)),
                least_ml_s: up(prepared.model.average_flow_ml_s(least_rad_s)),
            });
        }
        prepared.warnings.append(&mut device.notes);
        Ok(prepared)
    }

    /// Accepts the unfinished dose. The carry is zero afterwards.
    ///
    /// Returns the state, and the error if the device could not tell its count.
    ///
    /// # Errors
    ///
    /// [`DoseError::NothingUnfinished`] if no dose is unfinished. [`DoseError::Journal`] if the state cannot
    /// be recorded.
    pub fn discard(&mut self) -> Result<(State, Option<DoseError>), DoseError> {
        if self.stands().unfinished.is_none() {
            return Err(DoseError::NothingUnfinished("discard"));
        }
        // A device that still knows its count tells the steps made. Otherwise the recorded bounds stay, and
        // the count starts anew when the device is met again.
        let unasked = self.connect().err();
        let state = self.stands();
        let count = state.count.filter(|_| unasked.is_none());
        let state = State { unfinished: None, carry_ml: 0.0, count, ..state };
        self.rest(Why::Discarded, state)?;
        Ok((state, unasked))
    }

    /// Records that the tube is new. The carry is zero afterwards, and no calibration is used.
    ///
    /// # Errors
    ///
    /// [`DoseError`] if a dose is unfinished, or the calibrations or the state cannot be written.
    pub fn new_tube(&mut self) -> Result<NewTube, DoseError> {
        let before = self.finished()?;
        // Calibrations come first, so that no dose of the new tube uses the old tube's calibration.
        let calibrations = self.bench.calibrations();
        let unused = calibrations.active_version()?;
        calibrations.activate(None)?;
        let state = State { carry_ml: 0.0, wear: Wear::default(), ..before };
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
    pub fn finished(&self) -> Result<State, DoseError> {
        let state = self.stands();
        self.bench.refuse_unfinished(Some(state))?;
        Ok(state)
    }

    /// Records that the rotor stands. If that cannot be written, this session still knows it, and the next
    /// motion records it first.
    pub(super) fn rest(&mut self, why: Why, state: State) -> Result<(), JournalError> {
        self.state = Some(state);
        self.cut_off = None;
        self.written = false;
        self.journal.append(&Entry::Rest { unix_s: unix_s(), why, state })?;
        self.written = true;
        Ok(())
    }
}

/// Returns the system clock in seconds since 1970, for people who read the journal.
pub(super) fn unix_s() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |elapsed| elapsed.as_secs())
}
