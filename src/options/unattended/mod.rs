//! Doses that nobody watches: what becomes of an interrupted dose, of a disturbed angle, and of a failure.

use std::io::{self, IsTerminal};

use clap::Args;
use pump_bench::Bench;
use pump_bench::pump_file::{HomePolicy, PumpFile};
use pump_bench::safety::UnfinishedPolicy;

use super::choice::choice;
use crate::on_fail::OnFail;
use crate::options::pump::PumpOption;

/// A dose that nobody watches.
#[derive(Debug, Args)]
#[command(next_help_heading = "Unattended")]
pub(crate) struct UnattendedOptions {
    /// Do so with an interrupted dose on record [default: ask]
    #[arg(long, value_name = "ask|resume|accept", value_parser = choice(&[
        (UnfinishedPolicy::Ask, "Refuse this dose with exit code 4, so that a person decides"),
        (UnfinishedPolicy::Resume, "Make its rest first"),
        (UnfinishedPolicy::Accept, "Accept it as it is"),
    ]))]
    unfinished: Option<UnfinishedPolicy>,
    /// Nobody is there: obey `home` of the pump file's safety limits, also at a terminal
    #[arg(
        long_help = "Nobody is there: if the rollers' angle was disturbed since it was found, do as the pump file's \
        [safety] home says. Without a terminal at standard input this is so in any case."
    )]
    #[arg(long)]
    unattended: bool,
    /// Run this command of the shell if the dose fails or is refused
    #[arg(
        long_help = "Run this command of the shell if the dose fails or is refused. It has the reason on its standard \
        input, as one line of JSON (error/1), and DOSE_FAIL_PUMP, DOSE_FAIL_CODE, DOSE_FAIL_KIND, DOSE_FAIL_LEAST_ML \
        and DOSE_FAIL_MOST_ML in its environment. It has 10 s. The default of a dose without a terminal is the \
        configuration's on_fail."
    )]
    #[arg(long, value_name = "CMD")]
    on_fail: Option<String>,
}

impl UnattendedOptions {
    /// The policy for an interrupted dose on record.
    pub(crate) fn unfinished(&self) -> UnfinishedPolicy {
        self.unfinished.unwrap_or_default()
    }

    /// True if nobody is there: it is said, or standard input is no terminal.
    pub(crate) fn is_unattended(&self) -> bool {
        self.unattended || !io::stdin().is_terminal()
    }

    /// The bench that may find the angle of an interrupted dose before it makes the rest.
    pub(crate) fn change(&self, bench: Bench) -> Bench {
        let seeks = self.is_unattended() && by_sensor(bench.file());
        bench.homing_unfinished(seeks && self.unfinished() == UnfinishedPolicy::Resume)
    }

    /// The command to run if the dose fails; none without one.
    pub(crate) fn on_fail(&self, pump: &PumpOption) -> Option<OnFail> {
        let config = pump.config().ok();
        let configured = config.as_ref().and_then(|config| config.on_fail()).filter(|_| self.is_unattended());
        let command = self.on_fail.as_deref().or(configured)?;
        let name = config.as_ref().map_or(pump.typed(), |config| Some(pump.name(config)));
        Some(OnFail::new(command, name.unwrap_or_default()))
    }
}

/// True for a pump whose rotor turns to its index sensor if its angle was disturbed.
fn by_sensor(file: &PumpFile) -> bool {
    file.safety.home == Some(HomePolicy::Sensor)
}
