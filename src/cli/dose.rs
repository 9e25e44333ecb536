//! `dose <VOLUME>`, `dose prime`, `dose purge`.

use std::io::{self, Write};

use indicatif::{ProgressBar, ProgressStyle};
use pump_dose::pump_file::PumpFile;
use pump_dose::quantity::Amount;
use pump_dose::times::times;
use pump_dose::waveform::{Method, Waveform};
use pump_dose::{Bench, DoseReport, DoseRequest, Prepared, Purpose, csv};

use super::args::Options;
use super::outputs::{DEFAULT_DT_S, Outputs, PLOT_SAMPLES};
use super::{Failure, print};

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

fn run(command: &str, purpose: Purpose, amount: &Amount, options: &Options) -> Result<(), Failure> {
    options.accept_only(
        command,
        &[
            "--rate",
            "--speed",
            "--within",
            "--reverse",
            "--start-angle",
            "--max-outlet-pressure",
            "--min-inlet-pressure",
            "--driver",
            "--dry-run",
            "--format",
            "--steps",
            "--trace",
            "--plot",
            "--dt",
        ],
    )?;
    options.outputs_differ()?;
    if options.dt.is_some() && options.trace.is_none() {
        return Err(Failure::refused("--dt is the time between rows of --trace; name that file too"));
    }
    let bench = options.bench()?;
    let request = request(purpose, amount, options, bench.file())?;

    // The pump is taken before its record is read, so that nobody moves it in between.
    let session = if options.dry_run { None } else { Some(bench.session()?) };
    let prepared = bench.prepare(request)?;
    write_outputs(&bench, &prepared, options)?;
    let delivered_ml = match &session {
        None => None,
        Some(session) => {
            let bar = progress_bar(&prepared);
            let delivered_ml = session.run(&prepared, |steps| bar.set_position(steps));
            bar.finish_and_clear();
            Some(delivered_ml?)
        }
    };
    let report = DoseReport::new(&bench, &prepared, delivered_ml);
    let printed = if options.json() {
        for warning in &report.warnings {
            // Standard error is for people; if it is closed nobody reads it.
            let _ = writeln!(io::stderr(), "warning: {warning}");
        }
        print(&(report.json() + "\n"))
    } else {
        print(&report.text())
    };
    match (printed, delivered_ml) {
        (Err(Failure::Refused(message)), Some(delivered_ml)) => {
            Err(Failure::Fault(format!("{delivered_ml:.4} mL were delivered and recorded, but {message}")))
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
    let ambient_kpa = file.ambient.pressure_kpa;
    Ok(DoseRequest {
        purpose,
        volume_ml,
        cruise: options.cruise()?,
        start_angle_rad: options.start_angle,
        max_outlet_kpa: options.max_outlet_pressure.map(|pressure| pressure.absolute_kpa(ambient_kpa)),
        min_inlet_kpa: options.min_inlet_pressure.map(|pressure| pressure.absolute_kpa(ambient_kpa)),
    })
}

/// Writes the files that were asked for. They hold predictions, so they are there, all of them, before anything moves.
fn write_outputs(bench: &Bench, prepared: &Prepared, options: &Options) -> Result<(), Failure> {
    let plan = &prepared.plan;
    let motion_s = plan.profile.duration_s();
    let end_s = motion_s + prepared.prediction.settle_s;
    let samples = |dt_s| {
        Waveform::new(bench.model(), plan.legs(), Method::Exact, times(dt_s, motion_s, end_s))
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
