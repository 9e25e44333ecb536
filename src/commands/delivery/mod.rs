//! One delivery from the plan to the report: what doses, primes, purges and weighed runs have in common.

mod before_dose;

use std::cell::LazyCell;

use pump_bench::export::{Marks, write_steps};
use pump_bench::notice::Notice;
use pump_bench::record::Purpose;
use pump_bench::report::{Ending, ErrorKind};
use pump_bench::simulation::{Method, Waveform, times};
use pump_bench::{Bench, Delivered, DoseError, DoseReport, DoseRequest, Prepared, Session};

use crate::advice;
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::options::dosing::DosingOptions;
use crate::options::volume::AskedVolume;
use crate::outputs::{DEFAULT_DT_S, Outputs, PLOT_SAMPLES};
use crate::progress::MotionBar;
use crate::progress::supervised::{self, Reached};
use crate::terminal::{announcing, noted, print_json, tell, warn};
use crate::warned::Warned;

pub(in crate::commands) use before_dose::{Untold, before_dose, find_angle, find_angle_of_rest};

/// The message after a signal.
pub(super) const STOPPED: &str = "stopped by the user; `dose resume` makes the rest, `dose accept` leaves it";

/// The message after a signal to a run that goes on until it is stopped.
const RUN_STOPPED: &str = "stopped by the user; the run is complete and on record";

/// Most rows of a file: more are a mistake and would fill disks (a row has up to 150 bytes).
const MAX_ROWS: f64 = 1e8;

/// The delivery, and the signal that came, if one did.
pub(super) type DeliveryEnd = (Delivered, Option<i32>);

/// The message after a signal to a dose that has not begun to move.
const NOT_BEGUN: &str = "stopped by the user before the first step; no dose is unfinished";

/// Form of a report.
pub(super) struct Said<'a> {
    /// True if a program reads it.
    pub(super) json: bool,
    /// True if all details are wanted.
    pub(super) verbose: bool,
    /// The volume as it was typed.
    pub(super) asked: Option<&'a str>,
}

/// Delivers a volume for a purpose.
pub(super) fn run(purpose: Purpose, asked: &AskedVolume, options: &DosingOptions) -> Result<(), Failure> {
    options.check_files()?;
    let bench = options.bench()?;
    let request = options.request(purpose, asked, &bench)?;
    run_one(&bench, request, &options.typed(asked), options)
}

/// Plans, runs and reports one request, or with `--dry-run` plans and reports it.
pub(super) fn run_one(
    bench: &Bench,
    request: DoseRequest,
    typed: &str,
    options: &DosingOptions,
) -> Result<(), Failure> {
    let json = options.format.json();
    let said = Said { json, verbose: options.verbose.verbose, asked: Some(typed) };
    if options.dry_run {
        let mut prepared = bench.prepare(request)?;
        prepared.warnings.extend(options.start_angle.assumed(bench).map(Notice::from));
        write_outputs(bench, &prepared, options)?;
        return report(bench, &prepared, None, &said);
    }
    let interrupt = Interrupt::watch()?;
    // The pump is taken before its journal is read, so that nobody moves it in between.
    let mut session = bench.session()?;
    let mut before = before_dose(bench, &mut session, options, &interrupt)?;
    let prepared = session.prepare(request);
    let mut prepared =
        noted(&mut session, prepared).map_err(|error| Failure::from(error).of_session(&session))?;
    write_outputs(bench, &prepared, options).map_err(|failure| failure.of_session(&session))?;
    prepared.warnings.extend(before.notices());
    prepared.warnings.extend(options.start_angle.assumed(bench).map(Notice::from));
    let delivered = deliver(bench, &mut session, &prepared, &interrupt, json, &mut Warned::default());
    before.told(delivered.as_ref().err());
    report(bench, &prepared, Some(delivered?), &said)
}

/// True if a motion that was not told of has begun and failed. No report tells its warnings, and those of a plan that
/// was refused hide the reason: nothing comes of that plan.
pub(super) fn failed_untold<T>(made: &Result<T, DoseError>, was_told: bool) -> bool {
    !was_told && made.as_ref().is_err_and(|error| error.ending() == Ending::Moved)
}

/// Runs a dose, with its progress on standard error. A signal stops it. That a motor moves is said before it does, with
/// the warnings of kinds that were not `warned` of yet.
pub(super) fn deliver(
    bench: &Bench,
    session: &mut Session<'_>,
    prepared: &Prepared,
    interrupt: &Interrupt,
    json: bool,
    warned: &mut Warned,
) -> Result<DeliveryEnd, Failure> {
    // The report of a simulated motor tells them.
    let before = if warns_first(bench) { warned.untold(&prepared.warnings) } else { Vec::new() };
    let (delivered, was_told) = announcing(session, json, &before, |session| {
        supervised::begun(|| DoseReport::new(bench, prepared, None));
        let bar = LazyCell::new(|| MotionBar::of(&bench.file().pump.id, prepared, json));
        let delivered = session.run(prepared, |made| {
            bar.made(made, || Reached {
                delivered_ml: prepared.plan.delivered_ml(&prepared.model, made),
                angle_rad: prepared.plan.angle_after(made),
            });
            interrupt.flow()
        });
        bar.end();
        delivered
    })?;
    if failed_untold(&delivered, was_told) {
        let untold = if warns_first(bench) { before } else { warned.untold(&prepared.warnings) };
        warn(&untold);
    }
    let delivered = noted(session, delivered)?;
    if warns_first(bench) {
        warn(&warned.untold(&delivered.warnings));
    }
    Ok((delivered, interrupt.signal()))
}

/// True if warnings come before the motion and not with the report: before a real motor moves there is still time.
fn warns_first(bench: &Bench) -> bool {
    !bench.is_simulated()
}

/// Reports a dose, or a dry run.
pub(super) fn report(
    bench: &Bench,
    prepared: &Prepared,
    delivered: Option<DeliveryEnd>,
    said: &Said<'_>,
) -> Result<(), Failure> {
    let report = DoseReport::new(bench, prepared, delivered.as_ref().map(|(delivered, _)| delivered));
    let early = delivered.as_ref().and_then(|(end, _)| bench.ended_early(end));
    let range_ml = report.delivered_range_ml();
    let printed = report_once(bench, report, said, None, Vec::new(), &mut Warned::default());
    ended(printed, delivered, range_ml)?;
    let Some(error) = early else { return Ok(()) };
    // A run that a limit has ended is no success: its flow was to go on.
    Err(Failure::of(error).after_motion().delivered(range_ml))
}

/// Prints a report. Its warnings appear once: before and after the motion of a real motor, or here, and beside a report
/// for a program those of kinds that were not `warned` of yet. A program reads in the report what a person was `told`
/// before.
pub(super) fn report_once(
    bench: &Bench,
    report: DoseReport,
    said: &Said<'_>,
    of_batch: Option<(u64, u64)>,
    told: Vec<String>,
    warned: &mut Warned,
) -> Result<(), Failure> {
    let mut report = report.worded(advice::words);
    let was_run = report.delivered_ml.is_some();
    let has_warned = was_run && warns_first(bench);
    if said.json {
        if !has_warned {
            warn(&warned.untold(&report.warnings));
        }
        report.warnings.extend(told.into_iter().map(Notice::from));
        return print_json(&(report.json() + "\n"));
    }
    // The headline was printed before a real motor moved.
    let headline = if was_run && !report.simulated { String::new() } else { report.headline() + "\n" };
    // The details have the time of the dose.
    let text = if said.verbose {
        format!("{}\n{}", report.summary(said.asked, of_batch), report.details())
    } else {
        report.dated_summary(said.asked, of_batch)
    };
    if of_batch.is_some() {
        // Doses of a batch repeat what the first one warned of.
        report.warnings = warned.untold(&report.warnings);
    }
    let warnings = if has_warned { String::new() } else { report.warning_lines() };
    tell(&format!("{headline}{text}{warnings}"))
}

/// The failure of a report that could not be printed, after the pump moved.
pub(super) fn unprinted(failure: &Failure, volume_ml: f64, range_ml: (f64, f64)) -> Failure {
    let message = failure.message();
    let message = format!("{volume_ml:.4} mL were delivered and recorded, but {message}");
    Failure::fault(ErrorKind::Output, message).delivered(range_ml)
}

/// The end of the command after a dose (none: a dry run) whose report was printed or not. The dose delivered a volume
/// within `range_ml`, in mL.
pub(super) fn ended(
    printed: Result<(), Failure>,
    delivered: Option<DeliveryEnd>,
    range_ml: (f64, f64),
) -> Result<(), Failure> {
    match (printed, delivered) {
        (Err(failure), Some((Delivered { volume_ml, .. }, _))) if failure.is_refusal() => {
            Err(unprinted(&failure, volume_ml, range_ml))
        }
        (Ok(()), Some((delivered, signal))) if !delivered.completed => {
            let words = match (delivered.unfinished, delivered.made) {
                (true, _) => STOPPED,
                (false, 0) => NOT_BEGUN,
                (false, _) => RUN_STOPPED,
            };
            let stopped = Failure::stopped(signal.unwrap_or(0), delivered.made > 0, words);
            Err(stopped.delivered(range_ml))
        }
        (Ok(()), Some((delivered, Some(signal)))) if !delivered.sucked_back => Err(Failure::stopped(
            signal,
            true,
            "stopped by the user while it sucked back; the dose is delivered, and the next dose repays the volume that \
             was sucked back",
        )
        .delivered(range_ml)),
        (printed, _) => printed,
    }
}

/// Writes the files that were asked for. They hold predictions, so they are there, all of them, before anything moves.
fn write_outputs(bench: &Bench, prepared: &Prepared, options: &DosingOptions) -> Result<(), Failure> {
    let (plan, back) = (&prepared.plan, prepared.retraction.as_ref().map(|back| &back.plan));
    let (motion_s, end_s) = (prepared.motion_s(), prepared.settled_s());
    let samples = |dt_s| {
        Waveform::new(&prepared.model, prepared.legs(), Method::Exact, times(dt_s, motion_s, end_s))
            .map_err(Failure::of)
    };
    let mut outputs = Outputs::default();
    if let Some(path) = &options.steps.steps {
        let steps = plan.steps().unsigned_abs() + back.map_or(0, |back| back.steps().unsigned_abs());
        refuse_rows(steps as f64, "list of steps", "dose less at a time")?;
        let back = back.map(|back| (prepared.prediction.settle_s, back));
        outputs.write(path, |to| write_steps(to, plan, back))?;
    }
    if let Some(path) = &options.trace.trace {
        let dt_s = options.trace.dt.unwrap_or(DEFAULT_DT_S);
        refuse_rows(end_s / dt_s, "trace", "use a longer --dt")?;
        outputs.trace(path, samples(dt_s)?)?;
    }
    if let Some(path) = &options.plot.plot {
        let title = format!("{} mL on {} (predicted)", plan.requested_ml(), bench.file().pump.id);
        let marks = Marks {
            motion_s: Some(motion_s),
            asked_ml: Some(plan.requested_ml()),
            revolution_ml: Some(prepared.model.revolution_ml()),
        };
        outputs.plot(path, &title, samples(f64::max(end_s / PLOT_SAMPLES, DEFAULT_DT_S))?, &marks)?;
    }
    outputs.put()
}

/// Refuses a file of too many rows.
pub(super) fn refuse_rows(rows: f64, what: &str, instead: &str) -> Result<(), Failure> {
    if rows <= MAX_ROWS {
        Ok(())
    } else {
        let message = format!("the {what} would have {rows:.3e} rows, {MAX_ROWS:e} at most; {instead}");
        let refused = Failure::refused(message).kind(ErrorKind::Range);
        Err(refused.value(format!("{rows:.3e} rows")).allowed(format!("{MAX_ROWS:e} rows at most")))
    }
}
