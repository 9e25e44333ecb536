//! `dose <VOLUME>`, `dose prime`, `dose purge`, `dose resume`.

use std::io::{self, Write};
use std::ops::ControlFlow;

use indicatif::{ProgressBar, ProgressStyle};
use pump_bench::export::csv;
use pump_bench::pump_file::{DriverName, PumpFile};
use pump_bench::record::Purpose;
use pump_bench::simulation::times;
use pump_bench::simulation::{Method, Waveform};
use pump_bench::units::Amount;
use pump_bench::{Bench, Delivered, DoseReport, DoseRequest, Prepared, Session};
use pump_ctl::plan::Finish;

use super::batch;
use crate::failure::{Failure, print};
use crate::interrupt::Interrupt;
use crate::options::{FinishAt, Options};
use crate::outputs::{DEFAULT_DT_S, Outputs, PLOT_SAMPLES};

/// Said after a signal.
const STOPPED: &str = "stopped by the user; `dose resume` makes the rest, `dose discard` leaves it";

/// What decides on pressures.
const PRESSURES: [&str; 4] = ["--max-outlet-pressure", "--min-inlet-pressure", "--fluid", "--temperature"];

/// A file of more rows is a mistake: it would fill disks (a row has up to 150 bytes).
const MAX_ROWS: f64 = 1e8;

pub(crate) fn dose(amount: &Amount, options: &Options) -> Result<(), Failure> {
    run("dose", Purpose::Dose, amount, options)
}

pub(crate) fn prime(amount: &Amount, options: &Options) -> Result<(), Failure> {
    run("dose prime", Purpose::Prime, amount, options)
}

pub(crate) fn purge(amount: &Amount, options: &Options) -> Result<(), Failure> {
    run("dose purge", Purpose::Purge, amount, options)
}

/// Makes the rest of an unfinished dose.
pub(crate) fn resume(options: &Options) -> Result<(), Failure> {
    let device = ["--driver", "--port", "--configure"];
    let accepted =
        [&PRESSURES[..], &["--rate", "--speed", "--within", "--smooth", "--finish", "--format"], &device]
            .concat();
    options.accept_only("dose resume", &accepted)?;
    let bench = options.bench()?;
    let request = with_options(DoseRequest::dose(0.0), options, bench.file())?;
    let mut session = bench.session()?;
    let prepared = session.prepare_rest(request)?;
    let delivered = deliver(&bench, &mut session, &prepared, &watch()?, options)?;
    report(&bench, &prepared, Some(delivered), options)
}

fn run(command: &str, purpose: Purpose, amount: &Amount, options: &Options) -> Result<(), Failure> {
    let accepted = [
        &PRESSURES[..],
        &["--rate", "--speed", "--within", "--smooth", "--reverse", "--start-angle", "--dry-run", "--format"],
        &["--driver", "--port", "--configure"],
        &["--steps", "--trace", "--plot", "--dt", "--tube-limit"],
        if purpose == Purpose::Dose {
            &["--repeat", "--every", "--missed", "--retract", "--finish"]
        } else {
            &[]
        },
    ];
    options.accept_only(command, &accepted.concat())?;
    options.outputs_differ()?;
    if options.dt.is_some() && options.trace.is_none() {
        return Err(Failure::refused("--dt is the time between rows of --trace; name that file too"));
    }
    let schedule = batch::schedule(options)?;
    let bench = options.bench()?;
    let request = request(purpose, amount, options, bench.file())?;
    if let Some(schedule) = schedule {
        return batch::run(&bench, request, schedule, options);
    }
    if options.dry_run {
        let prepared = bench.prepare(request)?;
        write_outputs(&bench, &prepared, options)?;
        return report(&bench, &prepared, None, options);
    }
    // The pump is taken before its journal is read, so that nobody moves it in between.
    let mut session = bench.session()?;
    let prepared = session.prepare(request)?;
    write_outputs(&bench, &prepared, options)?;
    let delivered = deliver(&bench, &mut session, &prepared, &watch()?, options)?;
    report(&bench, &prepared, Some(delivered), options)
}

/// Signals stop doses from now on.
pub(crate) fn watch() -> Result<Interrupt, Failure> {
    Interrupt::watch().map_err(Failure::refused)
}

/// Runs a dose, with its progress on standard error. A signal stops it. That a motor moves is said before it does.
pub(crate) fn deliver(
    bench: &Bench,
    session: &mut Session<'_>,
    prepared: &Prepared,
    interrupt: &Interrupt,
    options: &Options,
) -> Result<(Delivered, Option<i32>), Failure> {
    announce(bench, options)?;
    if bench.driver() != DriverName::Sim {
        // Said again in the report; before the motor moves there is still time to stop it.
        warn(&prepared.warnings);
    }
    let bar = progress_bar(prepared);
    let delivered = session.run(prepared, |made| {
        bar.set_position(made);
        if interrupt.signal().is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    bar.finish_and_clear();
    Ok((delivered?, interrupt.signal()))
}

/// Says that a motor moves, before it does: to people on standard output, to the people behind a program on standard error.
pub(crate) fn announce(bench: &Bench, options: &Options) -> Result<(), Failure> {
    let headline = bench.headline() + "\n";
    if bench.driver() == DriverName::Sim {
        return Ok(());
    }
    if !options.json() {
        return print(&headline);
    }
    // Standard error is for people; if it is closed nobody reads it.
    let _ = io::stderr().write_all(headline.as_bytes());
    Ok(())
}

/// The report for people; its head was said already if a motor moved.
pub(crate) fn words(bench: &Bench, report: &DoseReport) -> String {
    let text = report.text();
    let moved = report.delivered_ml.is_some() && !report.simulated;
    let rest = text.strip_prefix(&bench.headline()).and_then(|rest| rest.strip_prefix('\n'));
    rest.filter(|_| moved).map_or(text.clone(), str::to_owned)
}

fn report(
    bench: &Bench,
    prepared: &Prepared,
    delivered: Option<(Delivered, Option<i32>)>,
    options: &Options,
) -> Result<(), Failure> {
    let report = DoseReport::new(bench, prepared, delivered.as_ref().map(|(delivered, _)| delivered));
    let printed = if options.json() {
        warn(&report.warnings);
        print(&(report.json() + "\n"))
    } else {
        print(&words(bench, &report))
    };
    ended(printed, delivered)
}

/// Warns a person whose program reads the report.
pub(crate) fn warn(warnings: &[String]) {
    for warning in warnings {
        // Standard error is for people; if it is closed nobody reads it.
        let _ = writeln!(io::stderr(), "warning: {warning}");
    }
}

/// How the command ends after a dose (none: a dry run) whose report was printed or not.
pub(crate) fn ended(
    printed: Result<(), Failure>,
    delivered: Option<(Delivered, Option<i32>)>,
) -> Result<(), Failure> {
    match (printed, delivered) {
        (Err(Failure::Refused(message)), Some((Delivered { volume_ml, .. }, _))) => {
            Err(Failure::Fault(format!("{volume_ml:.4} mL were delivered and recorded, but {message}")))
        }
        (Ok(()), Some((delivered, signal))) if !delivered.completed => {
            Err(Failure::Stopped(signal.unwrap_or(0), STOPPED.to_owned()))
        }
        (Ok(()), Some((delivered, Some(signal)))) if !delivered.sucked_back => {
            let words = "stopped by the user while it sucked back; the dose is delivered, and what was sucked back is owed";
            Err(Failure::Stopped(signal, words.to_owned()))
        }
        (printed, _) => printed,
    }
}

fn request(
    purpose: Purpose,
    amount: &Amount,
    options: &Options,
    file: &PumpFile,
) -> Result<DoseRequest, Failure> {
    let mut volume_ml = amount.volume_ml(file.fluid.density_kg_m3);
    if options.reverse {
        if volume_ml < 0.0 {
            return Err(Failure::refused(
                "--reverse and a negative volume both mean reverse; give one of them",
            ));
        }
        volume_ml = -volume_ml;
    }
    let asked = DoseRequest {
        purpose,
        start_angle_rad: options.start_angle,
        retract_ml: options.retract,
        ..DoseRequest::dose(volume_ml)
    };
    with_options(asked, options, file)
}

/// The same at the speed and within the pressures that were asked for.
fn with_options(request: DoseRequest, options: &Options, file: &PumpFile) -> Result<DoseRequest, Failure> {
    let ambient_kpa = file.ambient.pressure_kpa;
    Ok(DoseRequest {
        cruise: options.cruise()?,
        smooth: options.smooth,
        finish: match options.finish {
            Some(FinishAt::LowFlow) => Finish::LowFlow,
            Some(FinishAt::Any) | None => Finish::Any,
        },
        max_outlet_kpa: options.max_outlet_pressure.map(|pressure| pressure.absolute_kpa(ambient_kpa)),
        min_inlet_kpa: options.min_inlet_pressure.map(|pressure| pressure.absolute_kpa(ambient_kpa)),
        ..request
    })
}

/// Writes the files that were asked for. They hold predictions, so they are there, all of them, before anything moves.
fn write_outputs(bench: &Bench, prepared: &Prepared, options: &Options) -> Result<(), Failure> {
    let plan = &prepared.plan;
    let motion_s = plan.profile.duration_s();
    let end_s = motion_s + prepared.prediction.settle_s;
    let samples = |dt_s| {
        Waveform::new(&prepared.model, plan.legs(), Method::Exact, times(dt_s, motion_s, end_s))
            .map_err(Failure::refused)
    };
    let mut outputs = Outputs::default();
    if let Some(path) = &options.steps {
        refuse_rows(plan.steps.unsigned_abs() as f64, "list of steps", "dose less at a time")?;
        outputs.write(path, |to| csv::write_steps(to, plan))?;
    }
    if let Some(path) = &options.trace {
        let dt_s = options.dt.unwrap_or(DEFAULT_DT_S);
        refuse_rows(end_s / dt_s, "trace", "use a longer --dt")?;
        outputs.trace(path, samples(dt_s)?)?;
    }
    if let Some(path) = &options.plot {
        let title = format!("{} mL on {} (predicted)", plan.requested_ml, bench.file().pump.id);
        outputs.plot(path, &title, samples(f64::max(end_s / PLOT_SAMPLES, DEFAULT_DT_S))?, Some(motion_s))?;
    }
    outputs.put()
}

fn refuse_rows(rows: f64, what: &str, instead: &str) -> Result<(), Failure> {
    if rows <= MAX_ROWS {
        Ok(())
    } else {
        Err(Failure::refused(format!(
            "the {what} would have {rows:.3e} rows, {MAX_ROWS:e} at most; {instead}"
        )))
    }
}

fn progress_bar(prepared: &Prepared) -> ProgressBar {
    let style = ProgressStyle::with_template("{bar:40} {percent:>3} % of {len} steps, {eta} left");
    let bar = ProgressBar::new(prepared.plan.steps.unsigned_abs());
    bar.with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}
