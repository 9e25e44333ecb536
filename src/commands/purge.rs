//! `dose purge`: the line is emptied; the carry stays as it is.

use clap::Args;
use pump_bench::record::Purpose;

use super::delivery;
use super::run::{ForOption, deliver_for};
use crate::failure::Failure;
use crate::on_fail::OnFail;
use crate::options::dosing::DosingOptions;
use crate::options::volume::asked;

#[derive(Debug, Args)]
pub(crate) struct PurgeArgs {
    /// Volume with its unit, as 20mL; negative runs in reverse
    #[arg(value_name = "VOLUME")]
    volume: Vec<String>,
    #[command(flatten)]
    time: ForOption,
    #[command(flatten)]
    options: DosingOptions,
}

impl PurgeArgs {
    /// The command to run if this one fails.
    pub(crate) fn on_fail(&self) -> Option<OnFail> {
        self.options.on_fail()
    }

    pub(crate) fn run(&self) -> Result<(), Failure> {
        match &self.time.time {
            Some(_) if !self.volume.is_empty() => {
                Err(Failure::refused("a volume and --for exclude each other; give one of them"))
            }
            Some(time) => deliver_for(Purpose::Purge, time, &self.options),
            None => delivery::run(Purpose::Purge, &asked(&self.volume)?, &self.options),
        }
    }
}
