//! `dose run`: continuous flow until a time has passed, a volume is delivered, or somebody stops it; by a flow over
//! time; and a rack.

mod end;
mod profile;
mod rack;
mod rack_lines;
mod rack_warnings;

use std::path::PathBuf;

use clap::Args;
use pump_bench::dosing::RunEnd;
use pump_bench::record::Purpose;

use self::rack::RackArgs;
use super::delivery;
use crate::failure::Failure;
use crate::on_fail::OnFail;
use crate::options::dosing::DosingOptions;
use crate::options::volume::asked;

pub(super) use end::{ForOption, deliver_for};

/// Help of `--profile`.
const PROFILE_HELP: &str = "Follow a flow over time: CSV with the columns time_s,flow_ml_s, linear between rows; two \
                            rows of one time are a step. The flow is that at the rollers. What the motor cannot meet \
                            is refused with its first instant.";

#[derive(Debug, Args)]
pub(crate) struct RunArgs {
    #[command(flatten)]
    rack: RackArgs,
    #[command(flatten)]
    time: ForOption,
    /// Stop after this volume, as 1L; negative runs in reverse
    #[arg(long, value_name = "VOLUME", help_heading = "Amount and speed", conflicts_with = "for")]
    volume: Option<String>,
    /// Follow a flow over time: CSV with time_s,flow_ml_s
    #[arg(long, value_name = "FILE", help_heading = "Amount and speed", long_help = PROFILE_HELP)]
    #[arg(conflicts_with_all = ["for", "volume"])]
    profile: Option<PathBuf>,
    #[command(flatten)]
    options: DosingOptions,
}

impl RunArgs {
    /// The command to run if this one fails.
    pub(crate) fn on_fail(&self) -> Option<OnFail> {
        self.options
            .on_fail()
            .map(|on_fail| self.rack.name().map_or(on_fail.clone(), |name| on_fail.of_rack(name)))
    }

    pub(crate) fn run(&self) -> Result<(), Failure> {
        if let Some(name) = self.rack.name() {
            return self.rack.run(name, &self.options);
        }
        if let Some(path) = &self.profile {
            return profile::run(path, &self.options);
        }
        match (&self.time.time, &self.volume) {
            (Some(time), _) => deliver_for(Purpose::Run, time, &self.options),
            (None, Some(volume)) => {
                delivery::run(Purpose::Run, &asked(std::slice::from_ref(volume))?, &self.options)
            }
            (None, None) => self.until_stopped(),
        }
    }

    /// Runs until somebody stops it.
    fn until_stopped(&self) -> Result<(), Failure> {
        if let Some((name, _)) = self.options.files().iter().find(|(_, file)| file.is_some()) {
            return Err(Failure::refused(format!(
                "{name} is the file of a run with an end; give the run one with --for or --volume"
            )));
        }
        if self.options.moves_at_any_rate() {
            return Err(Failure::refused(
                "a run that goes on until it is stopped needs its rate: add --rate 10mL/min or --speed 30rpm, give it \
                 an end with --for or --volume, or name a rack",
            ));
        }
        if self.options.is_fast() {
            return Err(Failure::refused(
                "--pace fast takes no time, and a run until it is stopped ends by time; give it an end with --for or \
                 --volume, or leave --pace out",
            ));
        }
        end::deliver_until(Purpose::Run, RunEnd::Stop, "until stopped", &self.options)
    }
}
