//! A session: the pump is this process's; doses are run, and every stretch of them is on record before it happens.

use std::ops::ControlFlow;
use std::time::{SystemTime, UNIX_EPOCH};

use pump_ctl::plan::{Phase, Plan};
use pump_model::Pump;
use pump_model::math::{ceil, degrees};

use crate::bench::{Bench, DoseError};
use crate::dose::{DoseRequest, Prepared, Purpose};
use crate::drivers::{Drive, Sim};
use crate::folder::Lock;
use crate::journal::{Entry, Intent, Journal, JournalError, State, Wear, Why};
use crate::pump_file::DriverName;

/// Longest stretch between two entries of the journal, s and mL, whichever is shorter.
const STRETCH_S: f64 = 0.5;
const STRETCH_ML: f64 = 0.5;

/// Steps between two looks at whether to stop.
const WATCH_EVERY: u64 = 256;

/// A bench that no other process can move meanwhile.
#[derive(Debug)]
pub struct Session<'a> {
    bench: &'a Bench,
    journal: Journal,
    /// None if nothing was ever recorded.
    state: Option<State>,
    /// Whether the state is not on record yet as the rotor's rest.
    cut_off: bool,
    /// What turns the motor, opened by the first dose.
    drive: Option<Box<dyn Drive + 'a>>,
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
}

impl<'a> Session<'a> {
    pub(crate) fn open(bench: &'a Bench) -> Result<Self, DoseError> {
        let lock = bench.folder().lock()?;
        let (journal, story) = lock.journal(bench.model(), bench.fresh())?;
        Ok(Self { bench, journal, state: story.state, cut_off: story.cut_off, drive: None, _lock: lock })
    }

    /// How things stand; none if nothing was ever recorded.
    pub fn state(&self) -> Option<&State> {
        self.state.as_ref()
    }

    /// Plans a dose from the recorded angle and predicts it. Moves nothing.
    pub fn prepare(&self, request: DoseRequest) -> Result<Prepared, DoseError> {
        self.bench.prepare_from(self.state, request)
    }

    /// Plans the rest of the unfinished dose, at `cruise` or the pump's default rate: to the same end angle if what was
    /// delivered is known, to where it is most probably otherwise.
    pub fn prepare_rest(&self, request: DoseRequest) -> Result<Prepared, DoseError> {
        let state = self.state.unwrap_or(self.bench.fresh());
        let Some(dose) = state.unfinished else {
            return Err(DoseError::NothingUnfinished("resume"));
        };
        let (least_ml, most_ml) = dose.delivered_ml(self.bench.model());
        let intent = dose.intent;
        let volume_ml = intent.requested_ml - 0.5 * (least_ml + most_ml);
        let carry_ml = if intent.purpose == Purpose::Dose { intent.carry_in_ml } else { state.carry_ml };
        let rest = DoseRequest { purpose: intent.purpose, volume_ml, ..request };
        self.bench.plan_from(Some(State { unfinished: None, carry_ml, ..state }), rest)
    }

    /// Accepts the unfinished dose as it is. What doses owe is zero afterwards. Returns the state.
    pub fn discard(&mut self) -> Result<State, DoseError> {
        let state = self.state.unwrap_or(self.bench.fresh());
        if state.unfinished.is_none() {
            return Err(DoseError::NothingUnfinished("discard"));
        }
        let state = State { unfinished: None, carry_ml: 0.0, ..state };
        self.rest(Why::Discarded, state)?;
        Ok(state)
    }

    /// Records that the rotor stands at `phase`. What doses owe is zero afterwards. Refused with a dose unfinished.
    pub fn set_angle(&mut self, phase: Phase) -> Result<State, DoseError> {
        let state = State { carry_ml: 0.0, ..self.finished()?.at(phase) };
        self.rest(Why::Set, state)?;
        Ok(state)
    }

    /// Records that the tube is new. What doses owe is zero afterwards. Refused with a dose unfinished.
    pub fn new_tube(&mut self) -> Result<State, DoseError> {
        let state = State { carry_ml: 0.0, wear: Wear::default(), ..self.finished()? };
        self.rest(Why::NewTube, state)?;
        Ok(state)
    }

    /// The state, unless a dose is unfinished.
    fn finished(&self) -> Result<State, DoseError> {
        let state = self.state.unwrap_or(self.bench.fresh());
        let Some(dose) = state.unfinished else { return Ok(state) };
        let (least_ml, most_ml) = dose.delivered_ml(self.bench.model());
        Err(DoseError::Unfinished { requested_ml: dose.intent.requested_ml, least_ml, most_ml })
    }

    /// Runs a dose that this session prepared, and records what comes of it. `watch` is told now and then how many steps
    /// are made; when it breaks the motor decelerates and holds.
    pub fn run(
        &mut self,
        prepared: &Prepared,
        mut watch: impl FnMut(u64) -> ControlFlow<()>,
    ) -> Result<Delivered, DoseError> {
        let (plan, model) = (&prepared.plan, self.bench.model());
        let purpose = prepared.request.purpose;
        let stands = self.state.unwrap_or(self.bench.fresh()).phase();
        if prepared.request.start_angle_rad.is_none() && plan.start != stands {
            let [planned_deg, stands_deg] = [plan.start, stands].map(|phase| degrees(phase.angle_rad));
            return Err(DoseError::Stale { planned_deg, stands_deg });
        }
        if let (true, Some(state)) = (self.cut_off, self.state) {
            self.rest(Why::CutOff, state)?;
        }
        let intent = Intent::of(plan, purpose, prepared.carry_out_ml, unix_s());
        self.journal.append(&Entry::Intent(intent))?;

        let mut stretches = Stretches::new(plan, model);
        let mut unwritten: Option<JournalError> = None;
        let journal = &mut self.journal;
        let mut gate = |made: u64, about_to: u64| {
            let ends = about_to > stretches.end;
            // Drives that make many steps at a time ask seldom enough to look every time.
            let seldom = made.is_multiple_of(WATCH_EVERY) || about_to > made + 1;
            if (ends || seldom) && watch(made).is_break() {
                return ControlFlow::Break(());
            }
            if ends {
                let may = stretches.next(about_to);
                if let Err(error) = journal.append(&Entry::Progress { made, may }) {
                    unwritten = Some(error);
                    return ControlFlow::Break(());
                }
            }
            ControlFlow::Continue(())
        };

        let drive = self.drive.get_or_insert_with(|| match self.bench.driver() {
            DriverName::Sim => Box::new(Sim::new(model)),
        });
        let before = self.state.unwrap_or(self.bench.fresh());
        let made = match drive.run(plan, &mut gate) {
            Ok(made) => made,
            Err(fault) => {
                let state = before.after(&intent, fault.made_least, fault.made_most, model);
                let (least_ml, most_ml) = state
                    .unfinished
                    .map_or((plan.planned_ml, plan.planned_ml), |dose| dose.delivered_ml(model));
                // The journal's last stretch says as much, with wider bounds.
                let _ = self.rest(Why::Fault, state);
                return Err(DoseError::Drive { error: fault.error, least_ml, most_ml });
            }
        };
        let read_ml = drive.settle(prepared.prediction.settle_s);
        let counted_ml = plan.delivered_ml(model, made);
        let completed = made == plan.steps.unsigned_abs();
        let state = before.after(&intent, made, made, model);
        let end_angle_rad = plan.angle_after(made);
        let why = match (&unwritten, completed) {
            (Some(_), _) => Why::Fault,
            (None, true) => Why::Done,
            (None, false) => Why::Stopped,
        };
        let rested = self.rest(why, state);
        let volume_ml = match read_ml {
            Ok(read_ml) => read_ml.unwrap_or(counted_ml),
            Err(error) => return Err(DoseError::Drive { error, least_ml: counted_ml, most_ml: counted_ml }),
        };
        if let Some(source) = unwritten {
            return Err(DoseError::NotJournalled { delivered_ml: volume_ml, source });
        }
        rested.map_err(|source| DoseError::NotRecorded {
            delivered_ml: volume_ml,
            end_angle_deg: degrees(end_angle_rad),
            source,
        })?;
        Ok(Delivered { volume_ml, made, end_angle_rad, completed })
    }

    /// Records that the rotor stands. Where that cannot be written it is known to this session all the same, and the next
    /// dose writes it down first.
    fn rest(&mut self, why: Why, state: State) -> Result<(), JournalError> {
        self.state = Some(state);
        self.cut_off = true;
        self.journal.append(&Entry::Rest { unix_s: unix_s(), why, state })?;
        self.cut_off = false;
        Ok(())
    }
}

/// The stretches of a plan that the journal announces.
struct Stretches<'a> {
    plan: &'a Plan,
    /// Steps that give [`STRETCH_ML`] at most.
    steps: u64,
    /// Steps of a stop from the fastest speed.
    stop: u64,
    /// The last step of the stretch under way.
    end: u64,
}

impl<'a> Stretches<'a> {
    fn new(plan: &'a Plan, model: &Pump) -> Self {
        let (_, most_ml_rad) = model.outlet_curve().flow_range_ml_rad();
        let peak_rad_s = plan.profile.peak_rad_s();
        let stop_rad = peak_rad_s * peak_rad_s / (2.0 * plan.profile.acceleration_rad_s2());
        Self {
            plan,
            steps: ((STRETCH_ML / (most_ml_rad * plan.step_rad)) as u64).max(1),
            stop: ceil(stop_rad / plan.step_rad) as u64 + 1,
            end: 0,
        }
    }

    /// Goes on to the stretch that begins with step `first`. Returns how many steps may be made before the next entry:
    /// those of the stretch and of a stop at its end.
    fn next(&mut self, first: u64) -> u64 {
        let time_s = |step: u64| self.plan.profile.time_of(step as f64 * self.plan.step_rad);
        let latest_s = time_s(first) + STRETCH_S;
        let all = self.plan.steps.unsigned_abs();
        let (mut within, mut beyond) = (first, (first + self.steps).min(all + 1));
        while beyond - within > 1 {
            let middle = within + (beyond - within) / 2;
            if time_s(middle) <= latest_s {
                within = middle;
            } else {
                beyond = middle;
            }
        }
        self.end = within;
        (within + self.stop).min(all)
    }
}

/// Seconds since 1970, for people who read the journal.
fn unix_s() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |elapsed| elapsed.as_secs())
}
