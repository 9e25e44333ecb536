//! One pump of a rack: its thread takes the pump, plans its parts, and runs each at its time.

use std::cell::Cell;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender};

use libm::ceil;

use super::clock::{RackClock, SharedStop, Stop};
use super::progress::RackProgress;
use super::rack::Rack;
use super::rehearsal::{report, timings};
use super::report::RackDose;
use super::timetable::{Appointment, GIVEN_S, Timing};
use crate::bench::{Bench, SeriesMotion, SeriesRequest, Session, TimedVolume};
use crate::dosing::DoseError;
use crate::drives::Drive;
use crate::notice::Notice;
use crate::numbers::significant;
use crate::pump_file::Pace;

/// Lateness of a begin that is told, in s.
const LATE_S: f64 = 0.1;

/// Order to the thread of a pump.
pub(super) enum Order {
    /// Plan these parts, since a line has the pump run at another speed.
    Plan(Vec<SeriesRequest>),
    /// Check the volumes, with their times, against the safety limits.
    Check(Vec<TimedVolume>),
    /// Run the parts, each as it was appointed.
    Go(Vec<Appointment>, Arc<RackClock>),
}

/// Answer of the thread of a pump. A part is named by its place among the pump's parts.
pub(super) type Answer = Result<Vec<Timing>, (usize, DoseError)>;

/// Part of a rack that one pump was to run, and what became of it.
#[derive(Debug, Default)]
pub(super) struct Played {
    pub(super) doses: Vec<RackDose>,
    pub(super) warnings: Vec<Notice>,
    /// Number of each step that began late, from 1, and the time by which it did, in s.
    late: Vec<(usize, f64)>,
    pub(super) error: Option<DoseError>,
    /// Expanded uncertainty of the plan of the motion that failed, in mL.
    pub(super) failed_expanded_ml: f64,
    /// Time of the last step that the motion that failed has told, in s. `None` if it told none.
    pub(super) failed_end_s: Option<f64>,
    /// Error of a part that did not begin because another axis of its board did not.
    pub(super) followed: Option<DoseError>,
}

impl Played {
    /// The part of a pump whose thread has panicked.
    pub(super) fn panicked() -> Self {
        Self { error: Some(DoseError::Panicked), ..Self::default() }
    }

    /// Returns the warning of the steps that began late. Pumps of one board tell a like time in like words.
    pub(super) fn late_warning(&self) -> Option<Notice> {
        let most_s = self.late.iter().map(|(_, late_s)| *late_s).reduce(f64::max)?;
        let steps = self.late.iter().map(|(step, _)| step.to_string()).collect::<Vec<_>>().join(", ");
        let steps = if self.late.len() == 1 { format!("step {steps}") } else { format!("steps {steps}") };
        let most_s = significant(ceil(10.0 * most_s) / 10.0, 4);
        Some(format!("{steps} began up to {most_s} s late: the device or this computer was busy").into())
    }
}

/// Thread of a pump.
pub(super) struct Player<'a> {
    pub(super) rack: &'a Rack,
    pub(super) pump: usize,
    pub(super) bench: &'a Bench,
    pub(super) drive: Option<Box<dyn Drive + 'a>>,
    pub(super) stop: SharedStop,
    pub(super) orders: Receiver<Order>,
    pub(super) answers: Sender<(usize, Answer)>,
}

/// A thread that panics stops all pumps, and leaves nobody who waits for its answer.
impl Drop for Player<'_> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.stop.make(Stop::Fault(self.pump));
            let _ = self.answers.send((self.pump, Err((0, DoseError::Panicked))));
        }
    }
}

impl Player<'_> {
    /// Takes the pump, plans its parts, and runs them once all pumps are ready.
    pub(super) fn play(mut self, on_progress: &(dyn Fn(RackProgress<'_>) + Sync)) -> Played {
        let first = |error| (0, error);
        let drive = self.drive.take();
        let opened = match drive {
            Some(drive) => Session::with_drive(self.bench, drive),
            None => self.bench.session(),
        };
        let mut session = match opened {
            Ok(session) => session,
            Err(error) => {
                let _ = self.answers.send((self.pump, Err(first(error))));
                return Played::default();
            }
        };
        session.name_rack(self.rack.name());
        if is_unfinished(&session) {
            self.stop.let_count(self.pump);
        }
        let homed = if self.rack.unattended && !is_unfinished(&session) {
            session.keep_home_policy().map_err(first)
        } else {
            Ok(())
        };
        let mut requests = self.rack.requests(self.pump);
        let Some(mut prepared) = homed
            .map_or_else(|refused| self.answer(Err(refused)), |()| self.planned(&mut session, &requests))
        else {
            return Played::default();
        };
        let mut played = Played::default();
        while let Ok(order) = self.orders.recv() {
            match order {
                Order::Plan(at_speeds) => {
                    let Some(planned) = self.planned(&mut session, &at_speeds) else {
                        return played;
                    };
                    (prepared, requests) = (planned, at_speeds);
                }
                Order::Check(series) => {
                    if let Some(first) = prepared.first_mut() {
                        first.warn(session.notes());
                    }
                    let safe = session.keep_series_safe(&series);
                    played.warnings.append(&mut session.notes());
                    let _ = self.answers.send((self.pump, safe.map(|()| Vec::new()).map_err(first)));
                }
                Order::Go(appointments, clock) => {
                    let parts = Parts { requests: &requests, planned: &prepared, appointments };
                    self.run(&mut session, parts, &clock, &mut played, on_progress);
                    clock.leave(self.pump);
                    break;
                }
            }
        }
        played
    }

    /// Plans the parts of the pump, and tells their timings with what they take of the board, or the refusal. Returns
    /// the plan.
    fn planned(&self, session: &mut Session<'_>, requests: &[SeriesRequest]) -> Option<Vec<SeriesMotion>> {
        let planned = session.prepare_series(requests);
        self.answer(planned.and_then(|prepared| {
            let mut timings = timings(&prepared);
            for (place, (timing, motion)) in timings.iter_mut().zip(&prepared).enumerate() {
                timing.share = session.board_share(motion).map_err(|refused| (place, refused))?;
            }
            Ok((timings, prepared))
        }))
    }

    /// Tells the timings of a plan, or its refusal. Returns the plan.
    fn answer(
        &self,
        planned: Result<(Vec<Timing>, Vec<SeriesMotion>), (usize, DoseError)>,
    ) -> Option<Vec<SeriesMotion>> {
        let (told, prepared) = match planned {
            Ok((timings, prepared)) => (Ok(timings), Some(prepared)),
            Err(refused) => (Err(refused), None),
        };
        let _ = self.answers.send((self.pump, told));
        prepared
    }

    /// Runs the parts of the pump, each at its time.
    fn run(
        &self,
        session: &mut Session<'_>,
        parts: Parts<'_>,
        clock: &Arc<RackClock>,
        played: &mut Played,
        on_progress: &(dyn Fn(RackProgress<'_>) + Sync),
    ) {
        let steps: Vec<usize> = self.rack.parts(self.pump).collect();
        let Parts { requests, planned, appointments } = parts;
        for (number, ((planned, appointment), step)) in
            planned.iter().zip(appointments).zip(steps).enumerate()
        {
            // A part after the first begins where the one before has left the pump.
            let prepared =
                if number == 0 { Ok(planned.clone()) } else { session.prepare_motion(&requests[number]) };
            let (mut expanded_ml, last_s) = (0.0, Cell::new(None));
            let ran = prepared.and_then(|prepared| {
                expanded_ml = report(self.bench, &prepared, None).expanded_uncertainty_ml;
                let Appointment { begin_s, place } = appointment;
                place.map_or(Ok(()), |place| session.begin_with(place))?;
                let part = Part { player: self, clock, begin_s, step, prepared: &prepared, last_s: &last_s };
                part.run(session, on_progress, &mut played.late)
            });
            match ran {
                Ok(Some(dose)) => {
                    let is_whole = dose.dose.completed;
                    played.doses.push(dose);
                    if !is_whole {
                        return;
                    }
                }
                Ok(None) => return,
                Err(error) if error.is_stop() => return,
                Err(error) if error.is_of_another_axis() => {
                    if self.stop.cause().is_none() {
                        self.stop.make(Stop::Fault(self.pump));
                    }
                    played.followed = Some(error);
                    return;
                }
                Err(error) => {
                    self.stop.make(Stop::Fault(self.pump));
                    played.warnings.append(&mut session.notes());
                    let part = session.state().and_then(|state| state.unfinished);
                    let part_ml = part.and_then(|part| session.part_uncertainty_ml(&part));
                    (played.error, played.failed_expanded_ml) = (Some(error), part_ml.unwrap_or(expanded_ml));
                    played.failed_end_s = last_s.get();
                    return;
                }
            }
        }
    }
}

/// Returns true if an interrupted dose is on record. Planning refuses it.
fn is_unfinished(session: &Session<'_>) -> bool {
    session.state().is_some_and(|state| state.unfinished.is_some())
}

/// Parts of a pump, each with its request, its plan and its time.
struct Parts<'p> {
    requests: &'p [SeriesRequest],
    planned: &'p [SeriesMotion],
    appointments: Vec<Appointment>,
}

/// Part of a pump that is about to begin.
struct Part<'p> {
    player: &'p Player<'p>,
    clock: &'p Arc<RackClock>,
    begin_s: f64,
    /// Number of the step, from 0.
    step: usize,
    prepared: &'p SeriesMotion,
    /// Time of the last step that the motor has told, in s.
    last_s: &'p Cell<Option<f64>>,
}

impl Part<'_> {
    /// Runs the part at its time. Returns `None` if all were to stop before it began. A late step is added to `late`.
    fn run(
        &self,
        session: &mut Session<'_>,
        on_progress: &(dyn Fn(RackProgress<'_>) + Sync),
        late: &mut Vec<(usize, f64)>,
    ) -> Result<Option<RackDose>, DoseError> {
        let Self { player, clock, begin_s, prepared, .. } = *self;
        let is_simulated = player.bench.is_simulated();
        let given_s = if is_simulated { begin_s } else { begin_s - GIVEN_S };
        if clock.reach(player.pump, given_s).is_break() {
            return Ok(None);
        }
        // Every share of a step is on record before the first of them moves, so that a kill leaves none alone.
        let pumps = player.rack.pumps_of(self.step);
        if pumps.len() > 1 {
            let (clock, pump, step) = (Arc::clone(clock), player.pump, self.step);
            session.before_motion(move || clock.meet(pump, step, &pumps));
        }
        let (mut late_s, mut is_begun): (Option<f64>, bool) = (None, false);
        let lead_s = session.begin_lead_s();
        let delivered = session.run_motion(prepared, |made| {
            // A flow may make its first step long after its begin, so the first steps tell the lateness best.
            if late_s.is_none() || (made > 0 && !is_begun) {
                late_s = Some(clock.now_s() - begin_s - prepared.time_of(made));
                is_begun = made > 0;
            }
            if made == 0 || is_simulated {
                clock.reach(player.pump, begin_s + prepared.time_of(made) - lead_s)?;
            }
            if made > 0 {
                self.last_s.set(Some(begin_s + late_s.unwrap_or(0.0).max(0.0) + prepared.time_of(made)));
            }
            self.tell(made, on_progress);
            clock.flow()
        })?;
        self.tell(delivered.made, on_progress);
        let late_s = late_s.filter(|late_s| player.rack.pace == Pace::Real && *late_s > LATE_S);
        late.extend(late_s.map(|late_s| (self.step + 1, late_s)));
        let dose = report(player.bench, prepared, Some(&delivered));
        let unfinished = delivered.unfinished;
        let begin_s = begin_s + late_s.unwrap_or(0.0);
        Ok(Some(RackDose { step: self.step + 1, begin_s, unfinished, dose }))
    }

    fn tell(&self, made: u64, on_progress: &(dyn Fn(RackProgress<'_>) + Sync)) {
        let pump = &self.player.rack.members()[self.player.pump].name;
        let (steps, volume_ml) = (self.prepared.steps(), self.prepared.delivered_ml(made));
        let warnings = if made == 0 { &self.prepared.whole().warnings[..] } else { &[] };
        let (step, whole_ml) = (self.step + 1, self.prepared.planned_ml());
        let angle_rad = self.prepared.angle_after(made);
        on_progress(RackProgress { pump, step, made, steps, volume_ml, whole_ml, angle_rad, warnings });
    }
}
