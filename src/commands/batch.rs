//! `dose <VOLUME> --repeat <N>`: doses one after the other, each when it is due.

use std::mem;
use std::thread::sleep;
use std::time::{Duration, Instant};

use indicatif::ProgressBar;
use pump_bench::Rehearsal;
use pump_bench::dosing::{Schedule, ScheduleAction};
use pump_bench::notice::Notice;
use pump_bench::record::ClockWatch;
use pump_bench::report::ErrorKind;
use pump_bench::{Bench, DoseReport, DoseRequest, Prepared, Session, TimedVolume};
use pump_ctl::plan::Finish;

use super::delivery::{DeliveryEnd, Said, Untold, before_dose, deliver, ended, find_angle, report_once};
use crate::advice;
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::options::dosing::DosingOptions;
use crate::progress::supervised;
use crate::progress::until_next;
use crate::terminal::{is_reader_gone, noted, print, tell, waiting, warn};
use crate::warned::Warned;

/// Longest sleep between two looks for a signal.
const SLICE: Duration = Duration::from_millis(50);

/// Refuses files in a batch: each is the file of one dose.
pub(super) fn refuse_files(options: &DosingOptions, count: u64) -> Result<(), Failure> {
    match options.files().iter().find(|(_, file)| file.is_some()) {
        Some((name, _)) => Err(Failure::refused(format!(
            "{name} is the file of one dose, and --repeat asks for {count}; leave one of them out"
        ))),
        None => Ok(()),
    }
}

/// Makes the doses of `schedule`, or with `--dry-run` plans them. `typed` is the volume as it was typed, and `every_s`
/// the time from the start of one dose to the start of the next.
pub(super) fn run(
    bench: &Bench,
    request: DoseRequest,
    typed: &str,
    schedule: Schedule,
    every_s: Option<f64>,
    options: &DosingOptions,
) -> Result<(), Failure> {
    let (json, verbose) = (options.format.json(), options.verbose.verbose);
    let said = Said { json, verbose, asked: Some(typed) };
    let (count, assumed) = (schedule.count(), options.start_angle.assumed(bench));
    let mut batch = Batch {
        bench,
        said,
        request,
        assumed,
        count,
        done: 0,
        done_ml: (0.0, 0.0),
        skipped: 0,
        untold: Vec::new(),
        before: Untold::default(),
        options,
        total: Total::default(),
        clock: ClockWatch::of_system(),
        jumps: 0,
        warned: Warned::default(),
    };
    // A suck-back is repaid by the next dose, so that each pumps it too.
    let each_ml = request.volume_ml + request.retract_ml.unwrap_or(0.0);
    let (ended, verb) = if options.dry_run {
        let at = |number: u64| number as f64 * every_s.unwrap_or(0.0);
        let series: Vec<TimedVolume> =
            (0..count).map(|number| TimedVolume { at_s: at(number), volume_ml: each_ml }).collect();
        bench.check_series_safe(&series)?;
        (batch.rehearse(), "planned")
    } else {
        warn_of_release(bench, every_s);
        // One session and one watch for signals, so that nothing comes between two doses.
        let interrupt = Interrupt::watch()?;
        let mut session = bench.session()?;
        batch.before = before_dose(bench, &mut session, options, &interrupt)?;
        batch.refuse_missing_ends(&mut session, &interrupt)?;
        let safe = session.keep_batch_safe(each_ml, schedule.count(), every_s.unwrap_or(0.0));
        noted(&mut session, safe).map_err(|error| Failure::from(error).of_session(&session))?;
        (batch.run(&mut session, schedule, &interrupt), "done")
    };
    let printed = batch.print_total();
    let Batch { count, done, skipped, done_ml, .. } = batch;
    let missed = if skipped > 0 { Err(missed(skipped, count)) } else { Ok(()) };
    let skipped = if skipped > 0 { format!(" and {skipped} skipped") } else { String::new() };
    ended.and(printed).and(missed).map_err(|failure| {
        let failure = failure.delivered(done_ml);
        let failure = if done > 0 && !options.dry_run { failure.after_motion() } else { failure };
        failure.with(&format!("; {done} of {count} doses of the batch were {verb}{skipped}"))
    })
}

/// The failure of a batch that has skipped doses: a script must not take it for whole.
fn missed(skipped: u64, count: u64) -> Failure {
    let were = if skipped == 1 { "was" } else { "were" };
    Failure::failed(
        ErrorKind::Missed,
        format!(
            "{skipped} of {count} doses {were} not made: the time had passed; --missed now makes such a dose at once"
        ),
    )
}

/// Warns of a motor that is let go between the doses.
fn warn_of_release(bench: &Bench, every_s: Option<f64>) {
    let hold_s = bench.drive().hold_timeout_s.unwrap_or(f64::INFINITY);
    if let Some(every_s) = every_s.filter(|every_s| *every_s > hold_s) {
        warn(&[format!(
            "[drive] hold_timeout_s = {hold_s} is shorter than --every {every_s} s: the motor is let go between doses, \
             and after the second time nobody knows where the rollers stand"
        )]);
    }
}

struct Batch<'a> {
    bench: &'a Bench,
    said: Said<'a>,
    /// The next dose.
    request: DoseRequest,
    /// Message about the start angle that the first report repeats.
    assumed: Option<String>,
    count: u64,
    done: u64,
    /// Smallest and largest volume of the doses that were made in full, in mL.
    done_ml: (f64, f64),
    skipped: u64,
    /// Messages about skipped doses that the next report for a program repeats.
    untold: Vec<String>,
    /// Notices about what came before the batch, which the first report tells.
    before: Untold,
    options: &'a DosingOptions,
    total: Total,
    clock: ClockWatch,
    /// Number of jumps of the clock that were told.
    jumps: u64,
    /// Warnings that were printed. Each kind is printed once.
    warned: Warned,
}

/// Sums over the doses of a batch.
#[derive(Debug, Default)]
struct Total {
    doses: u64,
    volume_ml: f64,
    /// Largest error of the sum, in mL: as if every dose erred the same way.
    expanded_ml: f64,
}

impl Batch<'_> {
    fn rehearse(&mut self) -> Result<(), Failure> {
        let mut rehearsal = Rehearsal::new(self.bench)?;
        for number in 1..=self.count {
            let mut prepared = rehearsal.prepare(self.next_request())?;
            prepared.warnings.extend(self.assumed.take().map(Notice::from));
            self.done = number;
            self.report(number, &prepared, None)?;
            self.still_read()?;
        }
        Ok(())
    }

    /// Refuses a batch of which a dose would find no end at low flow, before its first dose. The carries of
    /// the doses before it decide that.
    fn refuse_missing_ends(&self, session: &mut Session<'_>, interrupt: &Interrupt) -> Result<(), Failure> {
        if self.request.finish != Some(Finish::LowFlow) {
            return Ok(());
        }
        let mut rehearsal = session.rehearsal()?;
        let mut request = self.request;
        for number in 1..=self.count {
            self.still_wanted(interrupt)?;
            if let Err(error) = rehearsal.prepare(request) {
                let place =
                    format!("; this is dose {number} of {} of the batch, and none was made", self.count);
                return Err(Failure::from(error).with(&place));
            }
            request.start_angle_rad = None;
        }
        Ok(())
    }

    fn run(
        &mut self,
        session: &mut Session<'_>,
        mut schedule: Schedule,
        interrupt: &Interrupt,
    ) -> Result<(), Failure> {
        // The clock starts with the first dose: a board may take seconds to answer.
        let mut started = None;
        // The doses that were skipped since the last one that was not.
        let mut missed = None;
        loop {
            let action = schedule.next(started.map_or(Duration::ZERO, |started: Instant| started.elapsed()));
            if let ScheduleAction::Skip(number) = action {
                missed = Some((missed.map_or(number, |(first, _)| first), number));
                continue;
            }
            if let Some((first, last)) = missed.take() {
                self.tell_skipped(first, last)?;
            }
            match action {
                ScheduleAction::Done => return Ok(()),
                ScheduleAction::Skip(_) => {}
                ScheduleAction::Wait(until) => {
                    let started = *started.get_or_insert_with(Instant::now);
                    self.wait(session, started, until, schedule.past() + 1, interrupt)?;
                }
                ScheduleAction::Dose(number) => {
                    self.still_wanted(interrupt)?;
                    self.tell_clock()?;
                    find_angle(session, self.options, interrupt)?;
                    let prepared = session.prepare(self.next_request());
                    let mut prepared = noted(session, prepared)?;
                    prepared.warnings.extend(self.before.notices());
                    prepared.warnings.extend(self.assumed.take().map(Notice::from));
                    started.get_or_insert_with(Instant::now);
                    let (json, warned) = (self.said.json, &mut self.warned);
                    let delivered = deliver(self.bench, session, &prepared, interrupt, json, warned);
                    self.before.told(delivered.as_ref().err());
                    let delivered = delivered?;
                    self.done += u64::from(delivered.0.completed);
                    self.tell_clock()?;
                    let (least_ml, most_ml) = self.report(number, &prepared, Some(delivered))?;
                    self.done_ml = (self.done_ml.0 + least_ml, self.done_ml.1 + most_ml);
                    self.still_read()?;
                }
            }
        }
    }

    /// The request of the next dose: only the first one's start angle is given, the others go on from there.
    fn next_request(&mut self) -> DoseRequest {
        let after = self.request.with_start_angle(None, 0.0);
        mem::replace(&mut self.request, after)
    }

    fn wait(
        &self,
        session: &mut Session<'_>,
        started: Instant,
        until: Duration,
        number: u64,
        interrupt: &Interrupt,
    ) -> Result<(), Failure> {
        let left = || until.saturating_sub(started.elapsed());
        supervised::waits(&self.bench.file().pump.id, left(), number, self.count);
        let sign = (!self.said.json).then(|| waiting(&until_next(left(), number, self.count)));
        let ended = loop {
            if let Err(error) = session.release_when_due() {
                break Err(error.into());
            }
            if let Err(failure) = self.still_wanted(interrupt) {
                break Err(failure);
            }
            let left = left();
            if left.is_zero() {
                break Ok(());
            }
            sign.iter().for_each(|sign| sign.set_message(until_next(left, number, self.count)));
            sleep(left.min(SLICE));
        };
        sign.iter().for_each(ProgressBar::finish_and_clear);
        ended
    }

    /// Ends a batch whose rotor stands.
    fn still_wanted(&self, interrupt: &Interrupt) -> Result<(), Failure> {
        let Some(signal) = interrupt.signal() else { return Ok(()) };
        Err(Failure::stopped(signal, false, "stopped by the user between two doses; nothing is unfinished"))
    }

    /// Ends a batch whose reports nobody reads: nobody would know of its doses.
    fn still_read(&self) -> Result<(), Failure> {
        if self.done == self.count || !is_reader_gone() {
            return Ok(());
        }
        Err(Failure::refused("nobody reads the reports of the batch any more").kind(ErrorKind::Output))
    }

    /// Tells of a jump of the computer's clock. The times of the doses do not follow it.
    fn tell_clock(&mut self) -> Result<(), Failure> {
        let Some(jump) = self.clock.look() else { return Ok(()) };
        self.jumps += 1;
        let message = format!("{jump}; the batch keeps its times by a clock that does not jump");
        if !self.said.json {
            return tell(&format!("warning: {message}\n"));
        }
        warn(std::slice::from_ref(&message));
        self.untold.push(message);
        Ok(())
    }

    fn tell_skipped(&mut self, first: u64, last: u64) -> Result<(), Failure> {
        self.skipped += last - first + 1;
        let count = self.count;
        let message = if first == last {
            format!("dose {first} of {count} was skipped: its time had passed")
        } else {
            format!("doses {first} to {last} of {count} were skipped: their times had passed")
        };
        if !self.said.json {
            return tell(&format!("{message}\n\n"));
        }
        warn(std::slice::from_ref(&message));
        self.untold.push(message);
        Ok(())
    }

    /// Reports a dose. Returns the smallest and the largest volume that it delivered, in mL.
    fn report(
        &mut self,
        number: u64,
        prepared: &Prepared,
        delivered: Option<DeliveryEnd>,
    ) -> Result<(f64, f64), Failure> {
        let report =
            DoseReport::new(self.bench, prepared, delivered.as_ref().map(|(delivered, _)| delivered));
        self.total.add(&report);
        let range_ml = report.delivered_range_ml();
        let printed = if self.said.json || self.said.verbose {
            let place = Some((number, self.count));
            let (untold, warned) = (mem::take(&mut self.untold), &mut self.warned);
            let printed = report_once(self.bench, report, &self.said, place, untold, warned);
            let space = if number < self.count && !self.said.json { print("\n") } else { Ok(()) };
            printed.and(space)
        } else {
            self.print_line(number, &report.worded(advice::words))
        };
        ended(printed, delivered, range_ml)?;
        Ok(range_ml)
    }

    /// Prints a dose as one line. The headline comes before the first, and a warning after the first dose that has one
    /// of its kind.
    fn print_line(&mut self, number: u64, report: &DoseReport) -> Result<(), Failure> {
        let was_run = report.delivered_ml.is_some();
        // A real motor was announced before it moved, and so were the warnings.
        let is_announced = was_run && !self.bench.is_simulated();
        let headline = match self.total.doses {
            1 if !is_announced => report.headline() + "\n",
            _ => String::new(),
        };
        let unsaid = if is_announced { Vec::new() } else { self.warned.untold(&report.warnings) };
        let unsaid: String = unsaid.iter().map(|warning| format!("warning: {warning}\n")).collect();
        let began = report.time.map_or(String::new(), |time| format!("{time}  "));
        let line = began + &report.batch_line(number, self.count);
        tell(&format!("{headline}{line}\n{unsaid}"))
    }

    /// Prints the total of a batch for people.
    fn print_total(&self) -> Result<(), Failure> {
        if self.said.json || self.total.doses == 0 {
            return Ok(());
        }
        let pump = &self.bench.file().pump.id;
        // Doses that were skipped or stopped were asked for too.
        let asked_ml = self.count as f64 * self.request.volume_ml;
        let jumps = match self.jumps {
            0 => String::new(),
            1 => "the computer's clock jumped once meanwhile: the log has the times that it showed\n"
                .to_owned(),
            jumps => {
                format!(
                    "the computer's clock jumped {jumps} times meanwhile: the log has the times that it showed\n"
                )
            }
        };
        tell(&(self.total.line(pump, self.count, asked_ml, self.options.dry_run) + &jumps))
    }
}

impl Total {
    fn add(&mut self, report: &DoseReport) {
        self.doses += 1;
        self.volume_ml += report.delivered_ml.unwrap_or(report.planned_ml);
        self.expanded_ml += report.expanded_uncertainty_ml;
    }

    /// The total in words. Doses of one pump err alike, so their uncertainties add up at most.
    fn line(&self, pump: &str, count: u64, asked_ml: f64, dry_run: bool) -> String {
        let Self { doses, volume_ml, expanded_ml } = self;
        let of_all = if *doses == count { String::new() } else { format!(" of {count}") };
        let verb = if dry_run { "planned" } else { "delivered" };
        format!(
            "{pump}: {doses}{of_all} doses, {volume_ml:.3} mL {verb} in all, {expanded_ml:.3} mL more or less at most; \
             {asked_ml:.3} mL requested\n"
        )
    }
}
