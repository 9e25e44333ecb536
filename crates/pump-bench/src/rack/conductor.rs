//! The run of a rack: all pumps plan, then check, then begin together by one timetable, and one stop ends them all.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;
use std::time::Duration;

use super::clock::{RackClock, SharedStop, Stop};
use super::error::RackError;
use super::player::{Answer, Order, Played, Player};
use super::progress::RackProgress;
use super::rack::Rack;
use super::report::{RackEnd, RackFault, RackPumpReport, RackReport};
use super::timetable::{LineSpeeds, Timetable, Timing, appointments, check_boards};
use crate::drives::Drive;
use crate::pump_file::Pace;
use crate::record::{Clock, Stamp, SystemClock};

/// Time from the order to the begin, in which each pump announces its first motion. Simulated motors need none.
const LEAD: Duration = Duration::from_millis(500);

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
        // A rack that is refused by the records alone resets no board.
        if self.members().iter().any(|member| member.bench.resets_as_met()) {
            self.check_records()?;
        }
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
            let played: Vec<Played> = threads
                .into_iter()
                .map(|thread| thread.join().unwrap_or_else(|_| Played::panicked()))
                .collect();
            let (timetable, began) = conducted?;
            Ok(self.reported(played, &timetable, began, &stop))
        })
    }

    /// Has all pumps plan, then check, then begin together. Returns the timetable with the time of its begin.
    fn conduct(
        &self,
        orders: &[Sender<Order>],
        heard: &Receiver<(usize, Answer)>,
        stop: &SharedStop,
    ) -> Result<(Timetable, Stamp), RackError> {
        let mut timings = vec![Vec::new(); self.members().len()];
        self.gather(heard, stop, &mut timings, orders.len())?;
        let (timetable, timings) = LineSpeeds::settle(self, timings, |speeds, slowed, timings| {
            for pump in slowed {
                let _ = orders[*pump].send(Order::Plan(speeds.requests(self, *pump)));
            }
            self.gather(heard, stop, timings, slowed.len())
        })?;
        check_boards(self, &timetable, &timings)?;
        for (pump, order) in orders.iter().enumerate() {
            let _ = order.send(Order::Check(self.series(pump, &timetable, &timings[pump])));
        }
        self.gather(heard, stop, &mut vec![Vec::new(); orders.len()], orders.len())?;
        if stop.cause().is_some() {
            return Err(RackError::Stopped);
        }
        let lead = if self.is_simulated() { Duration::ZERO } else { LEAD };
        let began = SystemClock.now();
        let clock = Arc::new(RackClock::new(self.pace, self.members().len(), lead, stop.clone()));
        for (order, appointments) in orders.iter().zip(appointments(self, &timetable.begins_s)) {
            let _ = order.send(Order::Go(appointments, clock.clone()));
        }
        Ok((timetable, began))
    }

    /// Waits for the answers of so many pumps, and takes in their timings. A refusal ends the waits of the pumps after
    /// it. Their records tell which of them wait for a person.
    fn gather(
        &self,
        heard: &Receiver<(usize, Answer)>,
        stop: &SharedStop,
        timings: &mut [Vec<Timing>],
        answers: usize,
    ) -> Result<(), RackError> {
        let (mut refused, mut called_off): (Vec<(usize, RackError)>, Vec<usize>) = Default::default();
        for _ in 0..answers {
            let Ok((pump, answer)) = heard.recv() else { break };
            match answer {
                Ok(told) => timings[pump] = told,
                Err((_, error)) if error.is_stop() => called_off.push(pump),
                Err(error) => {
                    stop.make(Stop::Refused(pump));
                    refused.push((pump, self.refused(pump, error)));
                }
            }
        }
        if !refused.is_empty() {
            refused.extend(called_off.into_iter().filter_map(|pump| Some((pump, self.waiting(pump)?))));
        }
        refused.sort_by_key(|(pump, _)| *pump);
        // A pump whose board is not there waits for a person all the same.
        for (pump, error) in refused.iter_mut().skip(1).filter(|(_, error)| !error.waits()) {
            if let Some(waits) = self.waiting(*pump) {
                *error = waits;
            }
        }
        match RackError::of_several(refused.into_iter().map(|(_, error)| error).collect()) {
            Some(error) => Err(error),
            None if stop.cause().is_some() => Err(RackError::Stopped),
            None => Ok(()),
        }
    }

    fn check_pace(&self) -> Result<(), RackError> {
        let real = self.members().iter().find(|member| !member.bench.is_simulated());
        match real.filter(|_| self.pace == Pace::Fast) {
            Some(member) => Err(RackError::RealPace { pump: member.name.clone() }),
            None => Ok(()),
        }
    }

    fn reported(
        &self,
        played: Vec<Played>,
        timetable: &Timetable,
        began: Stamp,
        stop: &SharedStop,
    ) -> RackReport {
        let mut faults = Vec::new();
        let mut rows = Vec::new();
        // An error that followed from another one is told where nobody knows the other.
        let is_unexplained = matches!(stop.cause(), Some(Stop::Fault(_)))
            && played.iter().all(|played| played.error.is_none());
        for (pump, (member, played)) in self.members().iter().zip(played).enumerate() {
            let late = played.late_warning();
            let Played { doses, warnings, error, failed_expanded_ml, failed_end_s, followed, .. } = played;
            let error = error.or(followed.filter(|_| is_unexplained));
            let (steps, requested_ml) = (self.parts(pump).count(), self.requested_ml(pump));
            let mut row = RackPumpReport::of(member, steps, requested_ml, doses);
            row.warnings.splice(0..0, warnings.into_iter().chain(late));
            let failed_part = self.requests(pump).into_iter().nth(row.doses.len());
            let over_time = failed_part.is_some_and(|part| part.profile.is_some());
            error.iter().for_each(|error| row.failed(error, failed_expanded_ml, over_time));
            row.failed_end_s = failed_end_s;
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
            Stop::Asked | Stop::Refused(_) => None,
        });
        let fault = if faults.is_empty() { None } else { Some(faults.swap_remove(first.unwrap_or(0))) };
        let report = RackReport::of(self, end, fault, timetable.ends_s, rows);
        // A motion that failed reports no time of its own.
        let began = report.ended_s.map(|_| began);
        RackReport { time: report.time.or(began), ..report }
    }
}
