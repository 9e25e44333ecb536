//! `dose serve`: the service that several people and programs share the pumps of one machine with.

#[cfg(feature = "serve")]
mod notes;
#[cfg(feature = "serve")]
mod place;
#[cfg(feature = "serve")]
mod running;
#[cfg(feature = "serve")]
pub(crate) mod secret;

use std::path::PathBuf;

use clap::Args;
use pump_bench::pump_file::Pace;

use crate::failure::Failure;
use crate::options::choice::choice;
use crate::options::pump::{ConfigOption, RecordOption};

#[derive(Debug, Args)]
pub(crate) struct ServeArgs {
    /// Address and port to listen at [default: 127.0.0.1:8737]
    #[arg(
        long_help = "Address and port to listen at. An address that other computers reach needs a token. The default \
        is that of [service] in the configuration, otherwise 127.0.0.1:8737."
    )]
    #[arg(long, value_name = "ADDRESS:PORT")]
    listen: Option<String>,
    /// File with the token that programs and people on other computers need
    #[arg(long, value_name = "FILE")]
    token_file: Option<PathBuf>,
    /// Schedule of the doses that come by the clock (TOML, schedule/1)
    #[arg(long, value_name = "FILE")]
    schedule: Option<PathBuf>,
    /// Pace of simulated motors [default: real]
    #[arg(long, value_name = "real|fast", value_parser = choice(&[
        (Pace::Real, "They take the time of their plans"),
        (Pace::Fast, "They take no time"),
    ]))]
    pace: Option<Pace>,
    #[command(flatten)]
    config: ConfigOption,
    #[command(flatten)]
    record: RecordOption,
}

impl ServeArgs {
    /// Runs the service until it is stopped.
    #[cfg(feature = "serve")]
    pub(crate) fn run(&self) -> Result<(), Failure> {
        running::run(self)
    }

    /// Refuses: this command was built without the service.
    #[cfg(not(feature = "serve"))]
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let Self { listen, token_file, schedule, pace, config, record } = self;
        let _ = (listen, token_file, schedule, pace, config, record);
        Err(Failure::refused(
            "this `dose` was built without the service; build it with `cargo run --features serve --bin dose -- \
             serve`",
        ))
    }
}
