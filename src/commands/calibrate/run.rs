//! `dose calibrate run`: runs in, a calibration out that the next dose uses.

use pump_bench::Bench;
use pump_bench::calibration::{Calibration, Run, Source, runs_of_csv};

use super::{FLUID, RunArgs, expected, guided, in_table, read, summary};
use crate::commands::home::DEVICE;
use crate::failure::{Failure, print};
use crate::options::Options;

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
    let before = bench.calibrations().active()?.map(|active| active.calibration);
    let expected = expected(bench, &args.reading)?;
    let mut calibration =
        Calibration::of_runs(bench.file(), source, runs, args.fit.into(), &expected, before.as_ref())?;
    calibration.tube = args.reading.tube.clone();
    calibration.note = args.reading.note.clone();
    let stored = bench.keep_calibration(calibration)?;
    print(&if options.json() { summary::json(&stored) } else { summary::text(bench, &stored)? })
}
