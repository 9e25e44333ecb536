//! The run of a rack: a thread for each pump, one timetable, and one stop for all.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;
use std::time::Duration;

use super::clock::{RackClock, SharedStop, Stop};
use super::error::RackError;
use super::pace::RackPace;
use super::progress::RackProgress;
use super::rack::Rack;
use super::rehearsal::{report, timings};
use super::report::{RackDose, RackEnd, RackFault, RackPumpReport, RackReport};
use super::timetable::{Appointment, Timetable, Timing, appointments};
use crate::bench::{Bench, SeriesMotion, Session, TimedVolume};
use crate::dosing::DoseError;
use crate::drives::Drive;
use crate::notice::Notice;
use crate::numbers::significant;

/// Time from the order to the begin, in which each pump announces its first motion. Simulated motors need none.
const LEAD: Duration = Duration::from_millis(500);

/// Time before its begin at which a motion is given to a real drive, in s.
const GIVEN_S: f64 = 0.3;

/// Lateness of a begin that is told, in s.
const LATE_S: f64 = 0.1;

/// Order to the thread of a pump.
enum Order {
    /// Check the volumes, with their times, against the safety limits.
    Check(Vec<TimedVolume>),
    /// Run the parts, each as it was appointed.
    Go(Vec<Appointment>, Arc<RackClock>),
}

/// Answer of the thread of a pump. A part is named by its place among the pump's parts.
type Answer = Result<Vec<Timing>, (usize, DoseError)>;

/// Part of a rack that one pump was to run, and what became of it.
#[derive(Debug, Default)]
struct Played {
    doses: Vec<RackDose>,
    warnings: Vec<Notice>,
    error: Option<DoseError>,
    /// Expanded uncertainty of the plan of the motion that failed, in mL.
    failed_expanded_ml: f64,
    /// Error of a part that did not begin because another axis of its board did not.
    followed: Option<DoseError>,
}

/// Thread of a pump.
struct Player<'a> {
    rack: &'a Rack,
    pump: usize,
    bench: &'a Bench,
    drive: Option<Box<dyn Drive + 'a>>,
    stop: SharedStop,
    orders: Receiver<Order>,
    answers: Sender<(usize, Answer)>,
}

impl Rack {
    /// Checks every step of every pump, then runs them. The threads of the pumps call `on_progress` before the first
    /// step of a motion and every 256 steps or 20 ms; it returns soon.
    ///
    /// # Errors
    ///
    /// [`RackError`] if a pump refuses its part. Nothing has moved. A fault in motion is in the report.
    pub fn run(&self, on_progress: impl Fn(RackProgress<'_>) + Sync) -> Result<RackReport, RackError> {
        self.run_with(self.members().iter().map(|_| None).collect(), on_progress)
    }

    /// Runs the rack with drives in the order of its pumps. A pump without one opens that of its file.
    ///
    /// # Errors
    ///
    /// [`RackError`] as for [`Rack::run`].
    pub fn run_with<'a>(
        &'a self,
        drives: Vec<Option<Box<dyn Drive + 'a>>>,
        on_progress: impl Fn(RackProgress<'_>) + Sync,
    ) -> Result<RackReport, RackError> {
        self.check_pace()?;
        let stop = self.shared_stop();
        let benches = self.benches(&stop);
        thread::scope(|scope| {
            let (answers, heard) = channel();
            let (mut orders, mut threads) = (Vec::new(), Vec::new());
            for ((pump, bench), drive) in benches.iter().enumerate().zip(drives) {
                let (order, received) = channel();
                let (stop, answers) = (stop.clone(), answers.clone());
                let player = Player { rack: self, pump, bench, drive, stop, orders: received, answers };
                let on_progress = &on_progress;
                orders.push(order);
                threads.push(scope.spawn(move || player.play(on_progress)));
            }
            drop(answers);
            let conducted = self.conduct(&orders, &heard, &stop);
            // A thread without orders gives its pump back.
            drop(orders);
            let played: Vec<Played> = threads.into_iter().filter_map(|thread| thread.join().ok()).collect();
            Ok(self.reported(played, &conducted?, &stop))
        })
    }

    /// Has all pumps plan, then check, then begin together.
    fn conduct(
        &self,
        orders: &[Sender<Order>],
        heard: &Receiver<(usize, Answer)>,
        stop: &SharedStop,
    ) -> Result<Timetable, RackError> {
        let timings = self.gathered(heard, stop)?;
        let timetable = Timetable::of(self.steps(), self.members(), &timings)?;
        for (pump, order) in orders.iter().enumerate() {
            let _ = order.send(Order::Check(self.series(pump, &timetable, &timings[pump])));
        }
        self.gathered(heard, stop)?;
        if stop.cause().is_some() {
            return Err(RackError::Stopped);
        }
        let lead = if self.is_simulated() { Duration::ZERO } else { LEAD };
        let clock = Arc::new(RackClock::new(self.pace, self.members().len(), lead, stop.clone()));
        for (order, appointments) in orders.iter().zip(appointments(self, &timetable.begins_s)) {
            let _ = order.send(Order::Go(appointments, clock.clone()));
        }
        Ok(timetable)
    }

    /// Waits for the answers of all pumps. A refusal ends the waits of the others.
    fn gathered(
        &self,
        heard: &Receiver<(usize, Answer)>,
        stop: &SharedStop,
    ) -> Result<Vec<Vec<Timing>>, RackError> {
        let mut timings = vec![Vec::new(); self.members().len()];
        let mut refused: Option<RackError> = None;
        for _ in 0..timings.len() {
            let Ok((pump, answer)) = heard.recv() else { break };
            match answer {
                Ok(told) => timings[pump] = told,
                Err((_, error)) if error.is_stop() => {}
                Err(error) => {
                    stop.make(Stop::Fault(pump));
                    refused.get_or_insert(self.refused(pump, error));
                }
            }
        }
        match refused {
            Some(error) => Err(error),
            None if stop.cause().is_some() => Err(RackError::Stopped),
            None => Ok(timings),
        }
    }

    fn check_pace(&self) -> Result<(), RackError> {
        let real = self.members().iter().find(|member| !member.bench.is_simulated());
        match real.filter(|_| self.pace == RackPace::Fast) {
            Some(member) => Err(RackError::RealPace { pump: member.name.clone() }),
            None => Ok(()),
        }
    }

    fn reported(&self, played: Vec<Played>, timetable: &Timetable, stop: &SharedStop) -> RackReport {
        let mut faults = Vec::new();
        let mut rows = Vec::new();
        // An error that followed from another one is told where nobody knows the other.
        let is_unexplained = matches!(stop.cause(), Some(Stop::Fault(_)))
            && played.iter().all(|played| played.error.is_none());
        for (pump, (member, played)) in self.members().iter().zip(played).enumerate() {
            let Played { doses, warnings, error, failed_expanded_ml, followed } = played;
            let error = error.or(followed.filter(|_| is_unexplained));
            let (steps, requested_ml) = (self.parts(pump).count(), self.requested_ml(pump));
            let mut row = RackPumpReport::of(member, steps, requested_ml, doses);
            row.warnings.splice(0..0, warnings);
            error.iter().for_each(|error| row.failed(error, failed_expanded_ml));
            rows.push(row);
            faults.extend(error.map(|error| RackFault { pump: member.name.clone(), error }));
        }
        let end = match stop.cause() {
            _ if !faults.is_empty() => RackEnd::Fault,
            _ if rows.iter().any(|row| !row.completed) => RackEnd::Stopped,
            _ => RackEnd::Completed,
        };
        let first = stop.cause().and_then(|cause| match cause {
            Stop::Fault(pump) => faults.iter().position(|fault| fault.pump == self.members()[pump].name),
            Stop::Asked => None,
        });
        let fault = if faults.is_empty() { None } else { Some(faults.swap_remove(first.unwrap_or(0))) };
        RackReport::of(self, end, fault, timetable.ends_s, rows)
    }
}

impl Player<'_> {
    /// Takes the pump, plans its parts, and runs them once all pumps are ready.
    fn play(mut self, on_progress: &(dyn Fn(RackProgress<'_>) + Sync)) -> Played {
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
        let homed = if self.rack.unattended && !is_unfinished(&session) {
            session.keep_home_policy().map_err(first)
        } else {
            Ok(())
        };
        let planned = homed.and_then(|()| session.prepare_series(&self.rack.requests(self.pump)));
        let prepared = match planned {
            Ok(prepared) => {
                let _ = self.answers.send((self.pump, Ok(timings(&prepared))));
                prepared
            }
            Err(refused) => {
                let _ = self.answers.send((self.pump, Err(refused)));
                return Played::default();
            }
        };
        let mut played = Played::default();
        while let Ok(order) = self.orders.recv() {
            match order {
                Order::Check(series) => {
                    let safe = session.keep_series_safe(&series);
                    played.warnings.append(&mut session.notes());
                    let _ = self.answers.send((self.pump, safe.map(|()| Vec::new()).map_err(first)));
                }
                Order::Go(appointments, clock) => {
                    self.run(&mut session, &prepared, appointments, &clock, &mut played, on_progress);
                    clock.leave(self.pump);
                    break;
                }
            }
        }
        played
    }

    /// Runs the parts of the pump, each at its time.
    fn run(
        &self,
        session: &mut Session<'_>,
        planned: &[SeriesMotion],
        appointments: Vec<Appointment>,
        clock: &RackClock,
        played: &mut Played,
        on_progress: &(dyn Fn(RackProgress<'_>) + Sync),
    ) {
        let steps: Vec<usize> = self.rack.parts(self.pump).collect();
        let requests = self.rack.requests(self.pump);
        for (number, ((planned, appointment), step)) in
            planned.iter().zip(appointments).zip(steps).enumerate()
        {
            // A part after the first begins where the one before has left the pump.
            let prepared =
                if number == 0 { Ok(planned.clone()) } else { session.prepare_motion(&requests[number]) };
            let mut expanded_ml = 0.0;
            let ran = prepared.and_then(|prepared| {
                expanded_ml = report(self.bench, &prepared, None).expanded_uncertainty_ml;
                let Appointment { begin_s, place } = appointment;
                place.map_or(Ok(()), |place| session.begin_with(place))?;
                let part = Part { player: self, clock, begin_s, step, prepared: &prepared };
                part.run(session, on_progress, &mut played.warnings)
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
                    (played.error, played.failed_expanded_ml) = (Some(error), expanded_ml);
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

/// Part of a pump that is about to begin.
struct Part<'p> {
    player: &'p Player<'p>,
    clock: &'p RackClock,
    begin_s: f64,
    /// Number of the step, from 0.
    step: usize,
    prepared: &'p SeriesMotion,
}

impl Part<'_> {
    /// Runs the part at its time. Returns `None` if all were to stop before it began.
    fn run(
        &self,
        session: &mut Session<'_>,
        on_progress: &(dyn Fn(RackProgress<'_>) + Sync),
        warnings: &mut Vec<Notice>,
    ) -> Result<Option<RackDose>, DoseError> {
        let Self { player, clock, begin_s, prepared, .. } = *self;
        let is_simulated = player.bench.is_simulated();
        let given_s = if is_simulated { begin_s } else { begin_s - GIVEN_S };
        if clock.reach(player.pump, given_s).is_break() {
            return Ok(None);
        }
        let mut late_s: f64 = 0.0;
        let delivered = session.run_motion(prepared, |made| {
            if made == 0 || is_simulated {
                late_s = if made == 0 { clock.now_s() - begin_s } else { late_s };
                clock.reach(player.pump, begin_s + prepared.time_of(made))?;
            }
            self.tell(made, on_progress);
            clock.flow()
        })?;
        self.tell(delivered.made, on_progress);
        if player.rack.pace == RackPace::Real && late_s > LATE_S {
            warnings.push(Notice::from(format!(
                "step {} began {} s late: the device or this computer was busy",
                self.step + 1,
                significant(late_s, 2)
            )));
        }
        let dose = report(player.bench, prepared, Some(&delivered));
        let unfinished = delivered.unfinished;
        Ok(Some(RackDose { step: self.step + 1, begin_s, unfinished, dose }))
    }

    fn tell(&self, made: u64, on_progress: &(dyn Fn(RackProgress<'_>) + Sync)) {
        let pump = &self.player.rack.members()[self.player.pump].name;
        let (steps, volume_ml) = (self.prepared.steps(), self.prepared.delivered_ml(made));
        let warnings = if made == 0 { &self.prepared.whole().warnings[..] } else { &[] };
        let (step, whole_ml) = (self.step + 1, self.prepared.planned_ml());
        on_progress(RackProgress { pump, step, made, steps, volume_ml, whole_ml, warnings });
    }
}
