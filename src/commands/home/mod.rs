//! `dose home`: where the rollers stand is found, or said.

mod keys;
mod mark;
mod sensor;
mod set;

use clap::{ArgGroup, Args};
use pump_bench::units::{self, StatedAngle};

use crate::failure::Failure;
use crate::options::bench::BenchOptions;
use crate::options::start_angle::stated_angle;

#[derive(Debug, Args)]
#[command(group = ArgGroup::new("angle").required(true).args(["mark", "sensor", "set", "unknown"]))]
pub(crate) struct HomeArgs {
    /// Turn the rotor with the arrow keys until its mark meets the housing's
    #[arg(long)]
    mark: bool,
    /// Tolerance of the angle that is said, or within which the two marks meet [default: 1deg, marks 0.5deg; a head
    /// without a drawing 11deg]
    #[arg(long, visible_alias = "mark-tolerance", value_name = "ANGLE", value_parser = units::tolerance_rad)]
    #[arg(conflicts_with_all = ["sensor", "unknown"])]
    tolerance: Option<f64>,
    /// Turn forward until the index sensor answers, a revolution at most
    #[arg(long)]
    sensor: bool,
    /// Do not ask before the sensor is looked for, whatever the pump pumps meanwhile
    #[arg(long, requires = "sensor")]
    yes: bool,
    /// Say the angle, as 30deg+-1deg; 0deg: a roller begins to leave the outlet
    #[arg(long, value_name = "ANGLE", value_parser = stated_angle)]
    set: Option<StatedAngle>,
    /// Say that nobody knows the angle: the rotor was turned by hand
    #[arg(long)]
    unknown: bool,
    /// Find the angle while a dose is unfinished: the dose and its carry stay on record
    #[arg(long)]
    unfinished: bool,
    #[command(flatten)]
    bench: BenchOptions,
}

impl HomeArgs {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let bench = || Ok(self.bench.bench()?.homing_unfinished(self.unfinished));
        if self.mark {
            mark::mark(self.tolerance, bench)
        } else if self.sensor {
            sensor::sensor(self.yes, &bench()?)
        } else {
            // Without an angle nobody knows it: clap asks for one of the four.
            debug_assert!(self.unknown || self.set.is_some(), "one of the group");
            set::set(self.set, self.tolerance, bench)
        }
    }
}
