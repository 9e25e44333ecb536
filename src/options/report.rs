//! The report: for whom, and how much of it.

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use pump_bench::report::Format;
use pump_bench::words::WordError;

/// The format of the report.
#[derive(Debug, Default, Args)]
#[command(next_help_heading = "Output")]
pub(crate) struct FormatOption {
    /// Report for people or programs [default: text]
    #[arg(long, value_name = "text|json", value_parser = format())]
    format: Option<Format>,
}

/// The length of the report.
#[derive(Debug, Args)]
#[command(next_help_heading = "Output")]
pub(crate) struct VerboseOption {
    /// Report every detail and the uncertainty budget
    #[arg(long, short)]
    pub(crate) verbose: bool,
}

impl FormatOption {
    /// True if a program reads the report.
    pub(crate) fn json(&self) -> bool {
        self.format == Some(Format::Json)
    }
}

/// Reads a format. `rust` is known elsewhere, so it is refused by what it is.
fn format() -> impl TypedValueParser<Value = Format> {
    let words = Format::ALL.iter().map(|format| PossibleValue::new(format.as_str()));
    let words = words.chain([PossibleValue::new("rust").hide(true)]);
    PossibleValuesParser::new(words).try_map(|word| match word.as_str() {
        "rust" => Err("`--format rust` belongs to `dose pumps show`; leave it out".to_owned()),
        word => word.parse().map_err(|error: WordError| error.to_string()),
    })
}
