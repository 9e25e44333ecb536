//! Where in a pitch a dose may end.

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use pump_ctl::plan::Finish;

/// The place of the end.
#[derive(Debug, Args)]
#[command(next_help_heading = "Amount and speed")]
pub(crate) struct FinishOption {
    /// Where in a pitch the dose may end [default: any]
    #[arg(long, value_name = "any|low-flow", value_parser = finish())]
    finish: Option<Finish>,
}

impl FinishOption {
    /// The place that is asked for.
    pub(crate) fn finish(&self) -> Finish {
        self.finish.unwrap_or_default()
    }
}

/// Reads the place of the end.
fn finish() -> impl TypedValueParser<Value = Finish> {
    let low_flow = "Where the flow is at most half of what it is between pulses: drips less, in finer steps";
    let words = [PossibleValue::new("any").help("Anywhere"), PossibleValue::new("low-flow").help(low_flow)];
    PossibleValuesParser::new(words)
        .map(|word| if word == "low-flow" { Finish::LowFlow } else { Finish::Any })
}
