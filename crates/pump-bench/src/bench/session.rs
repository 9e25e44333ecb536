//! A session: the pump is this process's; doses are run, and every stretch of them is on record before it happens.

use std::ops::ControlFlow;
use std::time::{SystemTime, UNIX_EPOCH};

use pump_model::math::{ceil, degrees, rpm};

use crate::dosing::DoseError;
use crate::dosing::{DoseRequest, Prepared};
use crate::numbers::{between, significant};
use crate::record::Lock;
use crate::record::{Entry, Journal, JournalError, Purpose, State, Terms, Unfinished, Wear, Why};

use super::bench::Bench;
use super::device::Device;
use super::recorded_motion::RecordedMotion;

/// A bench that no other process can move meanwhile.
#[derive(Debug)]
pub struct Session<'a> {
    pub(super) bench: &'a Bench,
    pub(super) journal: Journal,
    /// None if nothing was ever recorded.
    pub(super) state: Option<State>,
    /// Whether the state is on record as the rotor's rest.
    pub(super) written: bool,
    /// The motion under way when the process before this one ended, and how things stood before it.
    pub(super) cut_off: Option<(State, Unfinished)>,
    /// What turns the motor, opened when it is needed.
    pub(super) device: Option<Device<'a>>,
    /// Whether this session has turned the motor.
    pub(super) has_moved: bool,
    _lock: Lock,
}

/// What became of a dose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Delivered {
    /// What the vessel received, mL; where nobody can read it, the model volume of the steps made.
    pub volume_ml: f64,
    /// Steps made, without their sign.
    pub made: u64,
    /// Angle where the rotor stands, rad, counted on from the start.
    pub end_angle_rad: f64,
    /// Whether that is the whole dose.
    pub completed: bool,
    /// What was sucked back afterwards, mL, positive; 0 if nothing was.
    pub retracted_ml: f64,
    /// Whether that is all that was to be sucked back.
    pub sucked_back: bool,
}

/// A tube that was exchanged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NewTube {
    /// How things stand now.
    pub state: State,
    /// What the tube before pumped, mL.
    pub worn_ml: f64,
    /// What doses owed and is forgotten, mL.
    pub owed_ml: f64,
    /// The calibration of the tube before, which is not used any more.
    pub unused: Option<u32>,
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
            has_moved: false,
            _lock: lock,
        })
    }

    /// How things stand; none if nothing was ever recorded.
    pub fn state(&self) -> Option<&State> {
        self.state.as_ref()
    }

    /// What doses owe, mL.
    pub fn owed_ml(&self) -> f64 {
        self.stands().carry_ml
    }

    /// How things stand.
    pub(super) fn stands(&self) -> State {
        self.state.unwrap_or(self.bench.fresh())
    }

    /// Plans a dose from the recorded angle, within what the device allows, and predicts it. Moves nothing.
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

    /// Plans the rest of the unfinished dose as the whole was asked for, in what `request` leaves open (cruise, limits; a smooth
    /// flow stays smooth, an end at low flow one): to the same end angle if what was delivered is known, to where it is most
    /// probably otherwise.
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
                "of the {} mL asked for first, {} were delivered before; this rest is for the middle of that, so that {} will be \
                 delivered in all: `dose discard` accepts what is instead",
                significant(intent.requested_ml, 6),
                between(least_ml, most_ml),
                between(least_ml + rest_ml, most_ml + rest_ml),
            ));
        }
        self.checked(prepared)
    }

    /// Refuses what the device would do in another way, and adds what it has to say.
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

    /// Accepts the unfinished dose as it is. What doses owe is zero afterwards. Returns the state, and why the device could
    /// not say what it has counted, if it could not.
    pub fn discard(&mut self) -> Result<(State, Option<DoseError>), DoseError> {
        if self.stands().unfinished.is_none() {
            return Err(DoseError::NothingUnfinished("discard"));
        }
        // A device that still knows its count says what was made. Without it the bounds on record stay, and whatever it
        // counts when it is met again is where it begins.
        let unasked = self.connect().err();
        let state = self.stands();
        let count = state.count.filter(|_| unasked.is_none());
        let state = State { unfinished: None, carry_ml: 0.0, count, ..state };
        self.rest(Why::Discarded, state)?;
        Ok((state, unasked))
    }

    /// Records that the tube is new. What doses owe is zero afterwards, and no calibration is used. Refused with a dose
    /// unfinished.
    pub fn new_tube(&mut self) -> Result<NewTube, DoseError> {
        let before = self.finished()?;
        // First, so that no dose of the new tube is calibrated with the old one.
        let calibrations = self.bench.calibrations();
        let unused = calibrations.active_version()?;
        calibrations.activate(None)?;
        let state = State { carry_ml: 0.0, wear: Wear::default(), ..before };
        self.rest(Why::NewTube, state)?;
        Ok(NewTube { state, worn_ml: before.wear.volume_ml, owed_ml: before.carry_ml, unused })
    }

    /// The state, unless a dose is unfinished.
    pub fn finished(&self) -> Result<State, DoseError> {
        let state = self.stands();
        self.bench.refuse_unfinished(Some(state))?;
        Ok(state)
    }

    /// Runs a dose that this session prepared, and records what comes of it. `watch` is told now and then how many steps
    /// are made; when it breaks the motor decelerates and holds.
    pub fn run(
        &mut self,
        prepared: &Prepared,
        mut watch: impl FnMut(u64) -> ControlFlow<()>,
    ) -> Result<Delivered, DoseError> {
        let plan = &prepared.plan;
        let given = prepared.request.start_angle_rad.is_some();
        let stands = self.stands().phase();
        if !given && plan.start != stands {
            let [planned_deg, stands_deg] = [plan.start, stands].map(|phase| degrees(phase.angle_rad));
            return Err(DoseError::Stale { planned_deg, stands_deg });
        }
        let motion = RecordedMotion {
            plan,
            model: &prepared.model,
            correction: prepared.correction(),
            purpose: prepared.request.purpose,
            carry_out_ml: prepared.carry_out_ml,
            given,
            retract_ml: prepared.request.retract_ml,
            terms: prepared.terms(),
            settle_s: prepared.prediction.settle_s,
            seeks: false,
        };
        let moved = self.perform(&motion, &mut watch)?;
        let mut delivered = Delivered {
            volume_ml: moved.volume_ml,
            made: moved.made,
            end_angle_rad: plan.angle_after(moved.made),
            completed: moved.made == plan.steps.unsigned_abs(),
            retracted_ml: 0.0,
            sucked_back: prepared.retraction.is_none(),
        };
        if let Some(retraction) = prepared.retraction.as_ref().filter(|_| delivered.completed) {
            let plan = &retraction.plan;
            let motion = RecordedMotion {
                plan,
                model: &prepared.model,
                correction: prepared.correction(),
                purpose: Purpose::Retract,
                carry_out_ml: retraction.carry_out_ml,
                given: false,
                retract_ml: None,
                terms: Terms::default(),
                settle_s: retraction.prediction.settle_s,
                seeks: false,
            };
            // The dose is delivered and on record whatever becomes of the way back.
            let back = self.perform(&motion, &mut watch);
            let delivered_ml = delivered.volume_ml;
            let back =
                back.map_err(|source| DoseError::Retraction { delivered_ml, source: Box::new(source) })?;
            delivered.sucked_back = back.made == plan.steps.unsigned_abs();
            delivered.end_angle_rad = plan.angle_after(back.made);
            delivered.retracted_ml = -plan.delivered_ml(&prepared.model, back.made);
        }
        Ok(delivered)
    }

    /// Records that the rotor stands. Where that cannot be written it is known to this session all the same, and the next
    /// motion writes it down first.
    pub(super) fn rest(&mut self, why: Why, state: State) -> Result<(), JournalError> {
        self.state = Some(state);
        self.cut_off = None;
        self.written = false;
        self.journal.append(&Entry::Rest { unix_s: unix_s(), why, state })?;
        self.written = true;
        Ok(())
    }
}

/// Seconds since 1970, for people who read the journal.
pub(super) fn unix_s() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |elapsed| elapsed.as_secs())
}
