//! The speed of a dose: a rate, a speed or a time, one at most, and the ramps to it.

use clap::Args;
use pump_bench::units;
use pump_ctl::plan::{Cruise, Ramps};

use super::choice::choice_or;
use crate::failure::Failure;

/// A rate or a speed.
#[derive(Debug, Args)]
#[command(next_help_heading = "Amount and speed")]
pub(crate) struct SpeedOptions {
    /// Mean flow, as 10mL/s, or max
    #[arg(
        long_help = "Mean flow while cruising, as 10mL/s, or max: the fastest that holds every limit. The \
        default is the pump file's."
    )]
    #[arg(long, value_name = "FLOW", value_parser = units::rate)]
    rate: Option<Cruise>,
    /// Speed of the pump head, as 100rpm
    #[arg(long_help = "Speed of the pump head while cruising, as 100rpm.")]
    #[arg(long, value_name = "SPEED", value_parser = units::speed_rad_s)]
    speed: Option<f64>,
}

/// A rate, a speed, or the time in which a dose must be delivered.
#[derive(Debug, Args)]
#[command(next_help_heading = "Amount and speed")]
pub(crate) struct CruiseOptions {
    #[command(flatten)]
    speed: SpeedOptions,
    /// Total time with ramps and settling, as 10s
    #[arg(long, value_name = "TIME", value_parser = units::time_s)]
    within: Option<f64>,
}

impl CruiseOptions {
    /// True if a rate, a speed or a time is typed.
    pub(crate) fn is_given(&self) -> bool {
        self.within.is_some() || !matches!(self.speed.cruise(), Ok(None))
    }
}

/// The direction of the motion.
#[derive(Debug, Args)]
#[command(next_help_heading = "Amount and speed")]
pub(crate) struct ReverseOption {
    /// Run in reverse
    #[arg(long)]
    pub(crate) reverse: bool,
}

/// The angle of the rollers at the start.
#[derive(Debug, Args)]
#[command(next_help_heading = "Amount and speed")]
pub(crate) struct StartAngleOption {
    /// Angle of the rollers at the start, as 30deg [default: as recorded]
    #[arg(long_help = "Angle of the rollers at the start, as 30deg. At 0deg a roller begins to leave the \
        outlet. The default is the angle on record.")]
    #[arg(long, value_name = "ANGLE", value_parser = units::rotor_angle_rad)]
    pub(crate) start_angle: Option<f64>,
}

impl SpeedOptions {
    /// The cruise that is asked for.
    pub(crate) fn cruise(&self) -> Result<Option<Cruise>, Failure> {
        one_of([self.rate, self.speed.map(|rad_s| Cruise::Speed { rad_s })])
    }
}

impl CruiseOptions {
    /// The cruise that is asked for.
    pub(crate) fn cruise(&self) -> Result<Option<Cruise>, Failure> {
        one_of([self.speed.cruise()?, self.within.map(|time_s| Cruise::Within { time_s })])
    }
}

fn one_of(cruises: [Option<Cruise>; 2]) -> Result<Option<Cruise>, Failure> {
    match cruises {
        [Some(_), Some(_)] => {
            Err(Failure::refused("--rate, --speed and --within exclude each other; give one at most"))
        }
        [first, second] => Ok(first.or(second)),
    }
}

/// The ramps of a dose.
#[derive(Debug, Args)]
#[command(next_help_heading = "Amount and speed")]
pub(crate) struct RampsOption {
    /// Ramps in which the dose starts and stops [default: line]
    #[arg(long, value_name = "line|fastest")]
    #[arg(value_parser = choice_or(&[
        (Ramps::LineAware, "Ramps that leave the outlet's line nearly at rest: little back flow, and soon settled"),
        (Ramps::Fastest, "The largest acceleration; the default on a board that plans its own ramps"),
    ], &[(Ramps::LineAware, Ramps::EARLIER_NAME)]))]
    ramps: Option<Ramps>,
}

impl RampsOption {
    /// The ramps that are asked for; none without the option.
    pub(crate) fn ramps(&self) -> Option<Ramps> {
        self.ramps
    }
}
