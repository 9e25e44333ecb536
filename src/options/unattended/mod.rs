//! Doses that nobody watches: what becomes of an interrupted dose, of a disturbed angle, and of a failure.

use std::env;
use std::io::{self, IsTerminal};

use clap::Args;
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
    #[command(flatten)]
    on_fail: OnFailOption,
}

/// The command of the shell that a failure runs.
#[derive(Debug, Args)]
#[command(next_help_heading = "Unattended")]
pub(crate) struct OnFailOption {
    /// Run this command of the shell if this one fails or is refused
    #[arg(
        long_help = "Run this command of the shell if this one fails or is refused. It has the reason on its standard \
        input, as one line of JSON (error/1), and DOSE_FAIL_PUMP, DOSE_FAIL_RACK, DOSE_FAIL_CODE, DOSE_FAIL_KIND, \
        DOSE_FAIL_LEAST_ML and DOSE_FAIL_MOST_ML in its environment. It has 10 s. The default of a dose or its rest \
        without a terminal is the configuration's on_fail."
    )]
    #[arg(long, value_name = "CMD", hide_short_help = true)]
    on_fail: Option<String>,
}

impl OnFailOption {
    /// The command that the option names; none without one.
    pub(crate) fn named(&self, pump: &PumpOption) -> Option<OnFail> {
        let command = self.on_fail.as_deref()?;
        Some(OnFail::new(command, &pump_name(pump)))
    }

    /// The command that the option names, or else that of the configuration where nobody is there.
    pub(crate) fn or_configured(&self, pump: &PumpOption, is_unattended: bool) -> Option<OnFail> {
        let configured = || {
            let config = pump.config().ok().filter(|_| is_unattended)?;
            Some(OnFail::new(config.on_fail()?, pump.name(&config)).unless_answered())
        };
        self.named(pump).or_else(configured)
    }
}

/// The name of the pump, as far as anybody knows it.
fn pump_name(pump: &PumpOption) -> String {
    let configured = pump.config().ok().map(|config| pump.name(&config).to_owned());
    configured.or(pump.typed().map(str::to_owned)).unwrap_or_default()
}

/// True if standard input is no terminal. A service says whether the command that it carries out was typed at one.
pub(crate) fn has_no_terminal() -> bool {
    !io::stdin().is_terminal() && env::var_os("DOSE_ATTENDED").is_none()
}

impl UnattendedOptions {
    /// The policy for an interrupted dose on record.
    pub(crate) fn unfinished(&self) -> UnfinishedPolicy {
        self.unfinished.unwrap_or_default()
    }

    /// True if nobody is there: it is said, or standard input is no terminal.
    pub(crate) fn is_unattended(&self) -> bool {
        self.unattended || has_no_terminal()
    }

    /// The command to run if the dose fails; none without one.
    pub(crate) fn on_fail(&self, pump: &PumpOption) -> Option<OnFail> {
        self.on_fail.or_configured(pump, self.is_unattended())
    }
}
