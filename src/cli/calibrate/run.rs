//! `dose calibrate run`: runs in, a calibration out that the next dose uses.

use pump_ctl::plan::PlanError;
use pump_dose::Bench;
use pump_dose::calibration::{
    Calibration, Correction, Displacement, Run, Source, Stored, Weighing, runs_of_csv,
};

use super::super::args::Options;
use super::super::home::DEVICE;
use super::super::{Failure, print};
use super::{FLUID, RunArgs, expected, guided, in_table, read, summary};

pub(super) fn run(args: &RunArgs, options: &Options) -> Result<(), Failure> {
    let accepted: &[&str] = if args.from.is_some() { &["--driver"] } else { &DEVICE };
    options.accept_only("dose calibrate run", &[accepted, &FLUID, &["--format"]].concat())?;
    let bench = options.bench()?;
    let Some(path) = &args.from else {
        return match guided::runs(&bench, args, options)? {
            Some(runs) => keep(&bench, Source::Guided, runs, args, options),
            None => print("nothing is kept; doses go on as before\n"),
        };
    };
    let steps_per_rev = bench.file().limits().motor.steps_per_rev;
    let runs = in_table(path, runs_of_csv(&read(path)?, steps_per_rev))?;
    keep(&bench, Source::File, runs, args, options)
}

/// Fits the runs and has doses use what they show.
fn keep(
    bench: &Bench,
    source: Source,
    runs: Vec<Run>,
    args: &RunArgs,
    options: &Options,
) -> Result<(), Failure> {
    let _held = bench.folder().lock()?;
    let (file, calibrations) = (bench.file(), bench.calibrations());
    let weighing = Weighing::of(file);
    let mut calibration = Calibration::empty(file, source)?;
    if let Some(active) = calibrations.active()? {
        // The zero was found by other doses and stays.
        calibration.zero_deg = active.calibration.zero_deg;
        calibration.zero_standard_deg = active.calibration.zero_standard_deg;
        calibration.short_doses = active.calibration.short_doses;
    }
    let zero_rad = calibration.zero_rad();
    let pump = Correction { factor: 1.0, zero_rad }
        .of(bench.model())
        .map_err(PlanError::from)
        .map_err(Failure::refused)?;
    let displacement = Displacement::fit(&pump, &runs, &weighing, &expected(bench, &args.reading)?)?;
    calibration.temperature_degc =
        runs.iter().map(|run| run.temperature_degc(&weighing)).sum::<f64>() / runs.len() as f64;
    calibration.displacement = Some(displacement);
    calibration.runs = runs;
    calibration.tube = args.reading.tube.clone();
    calibration.note = args.reading.note.clone();
    let version = calibrations.add(&calibration)?;
    bench.use_calibration(Some(version))?;
    let stored = Stored { version, calibration };
    print(&if options.json() { summary::json(&stored) } else { summary::text(bench, &stored) })
}
