//! A dose that a balance ends.

use clap::Args;
use pump_bench::units::{self, Amount};
use pump_bench::{DoseRequest, OrderByWeight};
use pump_ctl::plan::Cruise;

use super::device::BalanceOptions;
use crate::failure::Failure;

/// A dose that a balance ends, in place of the model.
#[derive(Debug, Args)]
#[command(next_help_heading = "Balance")]
pub(crate) struct ByWeightOptions {
    /// Dispense by weight: the balance ends the dose
    #[arg(
        long_help = "Dispense by weight: the balance under the vessel ends the dose. The last part is dosed slowly, \
        and the motor stops so that what still falls makes up the rest. --scale-port or --scale-command names the \
        balance."
    )]
    #[arg(long)]
    pub(crate) until_scale: bool,
    /// Most that the pump may turn for in a dose by weight, by the model [default: the dose and its ±]
    #[arg(long, value_name = "VOLUME", value_parser = units::volume_ml, requires = "until_scale")]
    max_volume: Option<f64>,
    /// Flow of the last part of a dose by weight [default: a tenth of the dose's]
    #[arg(long, value_name = "FLOW", value_parser = units::rate, requires = "until_scale")]
    slow_rate: Option<Cruise>,
    /// Standard uncertainty of a reading, as 0.01g [default: of its last digit]
    #[arg(long, value_name = "MASS|VOLUME", value_parser = units::amount, requires = "until_scale")]
    pub(crate) scale: Option<Amount>,
}

impl ByWeightOptions {
    /// The order of a dose that this balance ends.
    pub(crate) fn order(&self, request: DoseRequest, balance: &BalanceOptions) -> OrderByWeight {
        OrderByWeight::new(request)
            .with_most_ml(self.max_volume)
            .with_slow(self.slow_rate)
            .with_longest(balance.longest_wait())
    }

    /// Refuses a balance without a dose by weight, and a dose by weight without a balance.
    pub(crate) fn check(&self, balance: &BalanceOptions) -> Result<(), Failure> {
        if !self.until_scale {
            return balance.refuse_without("--until-scale");
        }
        if balance.is_given() {
            return Ok(());
        }
        Err(Failure::refused(
            "--until-scale needs a balance; name its port with --scale-port, or a command that prints what it shows \
             with --scale-command",
        ))
    }
}
