//! The ramps in which a motion starts and stops.

use clap::Args;
use pump_ctl::plan::Ramps;

use super::choice::choice;

/// The ramps of a dose.
#[derive(Debug, Args)]
#[command(next_help_heading = "Amount and speed")]
pub(crate) struct RampsOption {
    /// Ramps in which the dose starts and stops [default: line-aware]
    #[arg(long, value_name = "line-aware|fastest")]
    #[arg(value_parser = choice(&[
        (Ramps::LineAware, "Ramps that leave the outlet's line nearly at rest: little back flow, and soon settled"),
        (Ramps::Fastest, "The largest acceleration; the default on a board that plans its own ramps"),
    ]))]
    ramps: Option<Ramps>,
}

impl RampsOption {
    /// The ramps that are asked for; none without the option.
    pub(crate) fn ramps(&self) -> Option<Ramps> {
        self.ramps
    }
}
