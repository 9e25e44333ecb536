//! The place in a pitch at which a dose may end.

use clap::Args;
use pump_ctl::plan::Finish;

use super::choice::choice;

/// The place of the end.
#[derive(Debug, Args)]
#[command(next_help_heading = "Amount and speed")]
pub(crate) struct FinishOption {
    /// Place in a pitch at which the dose may end [default: any]
    #[arg(long, value_name = "any|low-flow")]
    #[arg(value_parser = choice(&[
        (Finish::Any, "Anywhere"),
        (Finish::LowFlow, "Where the flow is at most half of that between pulses: drips less, in finer steps"),
    ]))]
    finish: Option<Finish>,
}

impl FinishOption {
    /// The place that is asked for; none without the option.
    pub(crate) fn finish(&self) -> Option<Finish> {
        self.finish
    }
}
