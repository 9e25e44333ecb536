//! `dose calibrate verify`: doses of one volume, their errors, and whether those are allowed.

use pump_bench::calibration::{Tolerance, Verification, Weighing, readings_of_csv};
use pump_bench::{Bench, DoseRequest};

use super::answers::{Answer, Answers, say, volume_ml};
use super::{FLUID, VerifyArgs, in_table, read};
use crate::commands::dose::{deliver, watch};
use crate::commands::home::DEVICE;
use crate::failure::{Failure, print};
use crate::options::Options;

/// Doses that ISO 8655-6 asks for.
const DOSES: u32 = 10;

pub(super) fn verify(args: &VerifyArgs, options: &Options) -> Result<(), Failure> {
    let from_table = args.from.is_some();
    let device: &[&str] = if from_table { &["--driver"] } else { &DEVICE };
    let cruise: &[&str] = if from_table { &[] } else { &["--rate", "--speed", "--within"] };
    options.accept_only("dose calibrate verify", &[device, cruise, &FLUID, &["--format"]].concat())?;
    let bench = options.bench()?;
    let nominal_ml = args.nominal.volume_ml(bench.file().fluid.density_kg_m3);
    if nominal_ml < 0.0 {
        return Err(Failure::refused("--volume is negative; verify forward doses"));
    }
    let tolerance = tolerance(args, nominal_ml)?;
    let weighing = Weighing::of(bench.file());
    let volumes_ml = match &args.from {
        Some(path) => in_table(path, readings_of_csv(&read(path)?, &weighing))?,
        None => match doses(&bench, nominal_ml, args, options)? {
            Some(volumes_ml) => volumes_ml,
            None => return print("nothing was verified\n"),
        },
    };
    let found = Verification::of(nominal_ml, volumes_ml, tolerance)?;
    print(&if options.json() { found.json() + "\n" } else { found.text() })?;
    if found.passed {
        Ok(())
    } else {
        Err(Failure::Fault(
            "the doses are not within their tolerance; calibrate, `dose calibrate run`".to_owned(),
        ))
    }
}

fn tolerance(args: &VerifyArgs, nominal_ml: f64) -> Result<Tolerance, Failure> {
    let standard = Tolerance::of_standard(nominal_ml);
    let either = |given: Option<f64>, of: fn(Tolerance) -> f64| given.or(standard.map(of));
    let systematic = either(args.systematic, |standard| standard.systematic_percent);
    let random = either(args.random, |standard| standard.random_percent);
    match (systematic, random) {
        (Some(systematic_percent), Some(random_percent)) => {
            Ok(Tolerance { systematic_percent, random_percent })
        }
        _ => Err(Failure::refused(format!(
            "for {nominal_ml} mL no standard's tolerance is known here (ISO 8655-5's is for 10 mL); give --systematic and \
             --random, as 0.6% and 0.2%"
        ))),
    }
}

/// Makes the doses and asks for what arrived, mL. None if the person left.
fn doses(
    bench: &Bench,
    nominal_ml: f64,
    args: &VerifyArgs,
    options: &Options,
) -> Result<Option<Vec<f64>>, Failure> {
    let (answers, interrupt) = (Answers::new(), watch()?);
    let mut session = bench.session()?;
    let all = args.runs.unwrap_or(DOSES);
    let request = DoseRequest { cruise: options.cruise()?, ..DoseRequest::dose(nominal_ml) };
    let weighing = Weighing::of(bench.file());
    let degc = weighing.fluid.temperature_degc;
    let mut volumes_ml = Vec::new();
    while volumes_ml.len() < all as usize {
        let title = format!("dose {} of {all}", volumes_ml.len() + 1);
        say(&format!("{title}: moving\n"));
        let prepared = session.prepare(request)?;
        let (delivered, signal) = deliver(bench, &mut session, &prepared, &interrupt, options)?;
        if !delivered.completed {
            let message =
                "stopped by the user in a dose; `dose resume` makes the rest, `dose discard` leaves it";
            return Err(Failure::Stopped(signal.unwrap_or(0), message.to_owned()));
        }
        match answers.reading(&title, &mut session, &interrupt)? {
            Answer::Read(reading) => volumes_ml.push(volume_ml(reading, &weighing, degc)?),
            Answer::Redo => {}
            Answer::Quit => return Ok(None),
        }
    }
    Ok(Some(volumes_ml))
}
