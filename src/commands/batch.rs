//! `dose <VOLUME> --repeat <N>`: doses one after the other, each when it is due.

use std::mem;
use std::thread::sleep;
use std::time::{Duration, Instant};

use pump_bench::bench::Rehearsal;

use pump_bench::dosing::{Action, MAX_DOSES, Missed, Schedule};
use pump_bench::{Bench, Delivered, DoseReport, DoseRequest, Prepared, Session};

use super::dose::{deliver, ended, warn, watch, words};
use crate::failure::{Failure, print};
use crate::interrupt::Interrupt;
use crate::options::{Missed as MissedName, Options};

/// Longest sleep between two looks for a signal.
const SLICE: Duration = Duration::from_millis(50);

/// The number behind `--repeat`.
pub(crate) fn number_of_doses(text: &str) -> Result<u64, String> {
    let number = text.parse().ok().filter(|number| (1..=MAX_DOSES).contains(number));
    number.ok_or_else(|| format!("allowed: whole numbers from 1 to {MAX_DOSES}, as in --repeat 10"))
}

/// The schedule of a batch; none for a single dose. Refuses what only a batch obeys, and what it cannot obey.
pub(crate) fn schedule(options: &Options) -> Result<Option<Schedule>, Failure> {
    if options.missed.is_some() && options.every.is_none() {
        return Err(Failure::refused(
            "--missed says what becomes of a dose whose time has passed; give the doses times with --every",
        ));
    }
    let Some(count) = options.repeat else {
        return match options.every {
            Some(_) => Err(Failure::refused(
                "--every is the time between the doses of a batch; say how many with --repeat",
            )),
            None => Ok(None),
        };
    };
    let missed = match options.missed.unwrap_or(MissedName::Skip) {
        MissedName::Skip => Missed::Skip,
        MissedName::Now => Missed::Now,
    };
    let schedule = Schedule::new(count, options.every, missed)
        .map_err(|error| Failure::refused(format!("--every: {error}")))?;
    let files = [("--steps", &options.steps), ("--trace", &options.trace), ("--plot", &options.plot)];
    match files.iter().find(|(_, file)| file.is_some()) {
        Some((name, _)) if count > 1 => Err(Failure::refused(format!(
            "{name} is the file of one dose, and --repeat asks for {count}; leave one of them out"
        ))),
        _ => Ok((count > 1).then_some(schedule)),
    }
}

/// Makes the doses of `schedule`, or with `--dry-run` plans them.
pub(crate) fn run(
    bench: &Bench,
    request: DoseRequest,
    schedule: Schedule,
    options: &Options,
) -> Result<(), Failure> {
    let mut batch =
        Batch { bench, options, request, count: schedule.count(), done: 0, skipped: 0, untold: Vec::new() };
    let (ended, verb) = if options.dry_run {
        (batch.rehearse(), "planned")
    } else {
        let hold_s = bench.drive().hold_timeout_s.unwrap_or(f64::INFINITY);
        if let Some(every_s) = options.every.filter(|every_s| *every_s > hold_s) {
            warn(&[format!(
                "[drive] hold_timeout_s = {hold_s} is shorter than --every {every_s} s: the motor is let go between doses, and \
                 after the second time nobody knows where the rollers stand"
            )]);
        }
        // One session and one watch for signals, so that nothing comes between two doses.
        let interrupt = watch()?;
        (batch.run(&mut bench.session()?, schedule, &interrupt), "done")
    };
    let Batch { count, done, skipped, .. } = batch;
    let skipped = if skipped > 0 { format!(" and {skipped} skipped") } else { String::new() };
    ended.map_err(|failure| {
        let failure = match failure {
            // Refused, but not before anything moved.
            Failure::Refused(message) if done > 0 && !options.dry_run => Failure::Fault(message),
            failure => failure,
        };
        failure.with(&format!("; {done} of {count} doses of the batch were {verb}{skipped}"))
    })
}

struct Batch<'a> {
    bench: &'a Bench,
    options: &'a Options,
    /// The next dose.
    request: DoseRequest,
    count: u64,
    done: u64,
    skipped: u64,
    /// Of what was skipped, what the next report is to say.
    untold: Vec<String>,
}

impl Batch<'_> {
    fn rehearse(&mut self) -> Result<(), Failure> {
        let mut rehearsal = Rehearsal::new(self.bench)?;
        for number in 1..=self.count {
            let prepared = rehearsal.prepare(self.next_request())?;
            self.done = number;
            self.report(number, &prepared, None)?;
        }
        Ok(())
    }

    fn run(
        &mut self,
        session: &mut Session<'_>,
        mut schedule: Schedule,
        interrupt: &Interrupt,
    ) -> Result<(), Failure> {
        let started = Instant::now();
        // The doses that were skipped since the last one that was not.
        let mut missed = None;
        loop {
            let action = schedule.next(started.elapsed());
            if let Action::Skip(number) = action {
                missed = Some((missed.map_or(number, |(first, _)| first), number));
                continue;
            }
            if let Some((first, last)) = missed.take() {
                self.tell_skipped(first, last)?;
            }
            match action {
                Action::Done => return Ok(()),
                Action::Skip(_) => {}
                Action::Wait(until) => self.wait(session, started, until, interrupt)?,
                Action::Dose(number) => {
                    self.still_wanted(interrupt)?;
                    let prepared = session.prepare(self.next_request())?;
                    let delivered = deliver(self.bench, session, &prepared, interrupt, self.options)?;
                    self.done += u64::from(delivered.0.completed);
                    self.report(number, &prepared, Some(delivered))?;
                }
            }
        }
    }

    /// The request of the next dose: only the first one's start angle is given, the others go on from there.
    fn next_request(&mut self) -> DoseRequest {
        let after = DoseRequest { start_angle_rad: None, ..self.request };
        mem::replace(&mut self.request, after)
    }

    fn wait(
        &self,
        session: &mut Session<'_>,
        started: Instant,
        until: Duration,
        interrupt: &Interrupt,
    ) -> Result<(), Failure> {
        loop {
            session.release_when_due()?;
            self.still_wanted(interrupt)?;
            let left = until.saturating_sub(started.elapsed());
            if left.is_zero() {
                return Ok(());
            }
            sleep(left.min(SLICE));
        }
    }

    /// Ends a batch whose rotor stands.
    fn still_wanted(&self, interrupt: &Interrupt) -> Result<(), Failure> {
        let Some(signal) = interrupt.signal() else { return Ok(()) };
        Err(Failure::Stopped(
            signal,
            "stopped by the user between two doses; nothing is unfinished".to_owned(),
        ))
    }

    fn tell_skipped(&mut self, first: u64, last: u64) -> Result<(), Failure> {
        self.skipped += last - first + 1;
        let count = self.count;
        let message = if first == last {
            format!("dose {first} of {count} was skipped: its time had passed")
        } else {
            format!("doses {first} to {last} of {count} were skipped: their times had passed")
        };
        if !self.options.json() {
            return print(&format!("{message} (--missed now makes them at once)\n\n"));
        }
        warn(std::slice::from_ref(&message));
        self.untold.push(message);
        Ok(())
    }

    fn report(
        &mut self,
        number: u64,
        prepared: &Prepared,
        delivered: Option<(Delivered, Option<i32>)>,
    ) -> Result<(), Failure> {
        let count = self.count;
        let mut report =
            DoseReport::new(self.bench, prepared, delivered.as_ref().map(|(delivered, _)| delivered));
        let printed = if self.options.json() {
            warn(&report.warnings);
            report.warnings.append(&mut self.untold);
            print(&(report.json() + "\n"))
        } else {
            let space = if number < count { "\n" } else { "" };
            print(&format!("{}  batch        dose {number} of {count}\n{space}", words(self.bench, &report)))
        };
        ended(printed, delivered)
    }
}
