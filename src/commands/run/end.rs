//! The end of a motion that a time or a stop ends.

use clap::Args;
use pump_bench::dosing::RunEnd;
use pump_bench::record::Purpose;
use pump_bench::units::{self, Amount};

use crate::commands::delivery;
use crate::failure::Failure;
use crate::options::dosing::DosingOptions;
use crate::options::volume::{AskedVolume, spaced};

/// The time of a motion.
#[derive(Debug, Args)]
#[command(next_help_heading = "Amount and speed")]
pub(crate) struct ForOption {
    /// Stop after this time, as 2h or 30s
    #[arg(long = "for", id = "for", value_name = "TIME", value_parser = asked_time)]
    pub(crate) time: Option<AskedTime>,
}

/// A time that was asked for.
#[derive(Debug, Clone)]
pub(crate) struct AskedTime {
    time_s: f64,
    /// The time as it was typed.
    typed: String,
}

fn asked_time(text: &str) -> Result<AskedTime, units::QuantityError> {
    Ok(AskedTime { time_s: units::time_s(text)?, typed: spaced(text) })
}

/// Runs the pump for a time.
pub(crate) fn deliver_for(
    purpose: Purpose,
    time: &AskedTime,
    options: &DosingOptions,
) -> Result<(), Failure> {
    deliver_until(purpose, RunEnd::Time { time_s: time.time_s }, &time.typed, options)
}

/// Runs the pump until `end`, which was typed as `typed`.
pub(super) fn deliver_until(
    purpose: Purpose,
    end: RunEnd,
    typed: &str,
    options: &DosingOptions,
) -> Result<(), Failure> {
    options.check_files()?;
    let bench = options.bench()?;
    // The library finds the volume. The sign of this one is the direction.
    let forward = AskedVolume { amount: Amount::Volume(1.0), typed: typed.to_owned() };
    let request = options.request(purpose, &forward, &bench)?.with_end(end);
    delivery::run_one(&bench, request, typed, options)
}
