//! `dose calibrate`: what the pump really delivers.

mod answers;
mod guided;
mod phase;
mod run;
mod summary;
mod verify;

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand, ValueEnum};
use pump_bench::Bench;
use pump_bench::calibration::{Expected, Fit};
use pump_bench::units;
use pump_bench::units::Amount;

use crate::failure::{Failure, print};
use crate::options::Options;

#[derive(Debug, Subcommand)]
pub(crate) enum CalibrateCommand {
    /// Weigh runs, or read them from a table, and use what they show from now on
    Run(RunArgs),
    /// Repeat a dose and report its systematic and random error as ISO 8655-6 does; exit code 1 if they are too large
    Verify(VerifyArgs),
    /// Find roller volume, engagement angle and zero from short doses at known start angles
    Phase(PhaseArgs),
    /// List the calibrations of this pump
    List,
    /// Use another calibration from now on
    Use {
        /// Its number, or none
        #[arg(value_name = "N|none")]
        version: String,
    },
}

/// What was weighed: the temperature of the fluid is that of its readings where a table says none.
const FLUID: [&str; 2] = ["--fluid", "--temperature"];

/// What is known of the readings.
#[derive(Debug, Args)]
pub(crate) struct ReadingArgs {
    /// Standard uncertainty of a reading of the scale or vessel, as 0.01g or 0.1mL
    #[arg(long, value_name = "MASS|VOLUME", value_parser = units::amount)]
    scale: Option<Amount>,
    /// The tube, for the record
    #[arg(long, value_name = "NAME")]
    tube: Option<String>,
    /// A note for the record
    #[arg(long, value_name = "TEXT")]
    note: Option<String>,
}

/// What is fitted to runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum FitName {
    Line,
    SpeedLaw,
}

impl From<FitName> for Fit {
    fn from(name: FitName) -> Self {
        match name {
            FitName::Line => Self::Line,
            FitName::SpeedLaw => Self::SpeedLaw,
        }
    }
}

#[derive(Debug, Args)]
pub(crate) struct RunArgs {
    /// Table of runs, CSV: speed_rpm, turned_deg (or revolutions, steps), mass_g (or volume_ml), start_angle_deg, ...
    #[arg(long, value_name = "FILE")]
    from: Option<PathBuf>,
    /// What is fitted: a straight line over the speed, or s and D of the speed law (three speeds at least)
    #[arg(
        long,
        value_name = "line|speed-law",
        default_value = "line",
        hide_default_value = true,
        value_enum
    )]
    fit: FitName,
    #[command(flatten)]
    reading: ReadingArgs,
    /// Speeds of the guided runs, as 20rpm,60rpm,100rpm [default: three that reach from half the default rate to the limit]
    #[arg(long, value_name = "SPEEDS", value_delimiter = ',', value_parser = units::speed_rad_s, conflicts_with = "from")]
    speeds: Vec<f64>,
    /// Guided runs at each speed [default: 3]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100), conflicts_with = "from")]
    runs: Option<u32>,
    /// Whole pitches of each guided run [default: 50 mL or more]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000), conflicts_with = "from")]
    pitches: Option<u32>,
}

#[derive(Debug, Args)]
pub(crate) struct VerifyArgs {
    /// The dose, with its unit
    #[arg(long = "volume", value_name = "VOLUME", value_parser = units::amount)]
    nominal: Amount,
    /// How many doses [default: 10]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=1000), conflicts_with = "from")]
    runs: Option<u32>,
    /// Systematic error allowed, as 0.6% [default: ISO 8655-5's for 10 mL]
    #[arg(long, value_name = "PERCENT", value_parser = percent)]
    systematic: Option<f64>,
    /// Random error (CV) allowed, as 0.2% [default: ISO 8655-5's for 10 mL]
    #[arg(long, value_name = "PERCENT", value_parser = percent)]
    random: Option<f64>,
    /// Table of doses that were made before, CSV: mass_g or volume_ml, temperature_degc
    #[arg(long, value_name = "FILE")]
    from: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct PhaseArgs {
    /// Table of short doses, CSV: start_angle_deg, turned_deg, mass_g or volume_ml, temperature_degc
    #[arg(long, value_name = "FILE", required = true)]
    from: PathBuf,
    #[command(flatten)]
    reading: ReadingArgs,
    /// Correct the zero of the angle by what was found, from now on
    #[arg(long = "use")]
    uses: bool,
}

pub(crate) fn calibrate(command: Option<&CalibrateCommand>, options: &Options) -> Result<(), Failure> {
    match command {
        Some(CalibrateCommand::Run(args)) => run::run(args, options),
        Some(CalibrateCommand::Verify(args)) => verify::verify(args, options),
        Some(CalibrateCommand::Phase(args)) => phase::phase(args, options),
        Some(CalibrateCommand::List) | None => list(options),
        Some(CalibrateCommand::Use { version }) => use_version(version, options),
    }
}

fn list(options: &Options) -> Result<(), Failure> {
    options.accept_only("dose calibrate list", &["--driver", "--format"])?;
    let bench = options.bench()?;
    let calibrations = bench.calibrations();
    let (all, active) = (calibrations.list()?, calibrations.active_version()?);
    print(&if options.json() {
        summary::list_json(&all, active)
    } else {
        summary::list(&bench, &all, active)
    })
}

fn use_version(version: &str, options: &Options) -> Result<(), Failure> {
    options.accept_only("dose calibrate use", &["--driver"])?;
    let bench = options.bench()?;
    let wanted = match version {
        "none" => None,
        number => Some(number.parse().map_err(|_| {
            Failure::refused(format!(
                "`{number}` is no calibration; write its number from `dose calibrate list`, or none"
            ))
        })?),
    };
    let _held = bench.folder().lock()?;
    bench.use_calibration(wanted)?;
    print(&wanted.map_or("doses use no calibration from now on\n".to_owned(), |version| {
        format!("doses use calibration {version} from now on\n")
    }))
}

/// What is expected of the readings of a bench.
fn expected(bench: &Bench, reading: &ReadingArgs) -> Result<Expected, Failure> {
    let file = bench.file();
    let reading_ml = reading.scale.map_or(0.0, |scale| scale.volume_ml(file.fluid.density_kg_m3));
    if reading_ml < 0.0 {
        return Err(Failure::refused("--scale is negative; write how unsure a reading is, as 0.01g"));
    }
    Ok(Expected::of(file, reading_ml))
}

/// A table that a person wrote.
fn read(path: &Path) -> Result<String, Failure> {
    std::fs::read_to_string(path)
        .map_err(|error| Failure::refused(format!("cannot read {}: {error}", path.display())))
}

/// Says in which table an error is.
fn in_table<T>(
    path: &Path,
    found: Result<T, pump_bench::calibration::CalibrationError>,
) -> Result<T, Failure> {
    found.map_err(|error| Failure::refused(format!("{}: {error}", path.display())))
}

fn percent(text: &str) -> Result<f64, String> {
    let wrong = || format!("`{text}` is no percentage; write for example 0.6%");
    let number = text.strip_suffix('%').ok_or_else(wrong)?;
    let value: f64 = number.trim().parse().map_err(|_| wrong())?;
    if value > 0.0 && value <= 100.0 {
        Ok(value)
    } else {
        Err(format!("`{text}` is not between 0% and 100%"))
    }
}
