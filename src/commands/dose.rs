//! `dose <VOLUME>`: one dose, or a batch of them.

use clap::Args;
use pump_bench::record::Purpose;
use pump_bench::units;

use super::{batch, by_weight, delivery};
use crate::failure::Failure;
use crate::on_fail::OnFail;
use crate::options::balance::{BalanceOptions, ByWeightOptions};
use crate::options::batch::BatchOptions;
use crate::options::dosing::DosingOptions;
use crate::options::finish::FinishOption;
use crate::options::volume::asked;
use crate::refusals::is_name;

#[derive(Debug, Args)]
pub(crate) struct DoseArgs {
    /// Volume or mass with its unit: 25mL, 0.025L, 250uL, 25g; negative runs in reverse
    #[arg(value_name = "VOLUME")]
    volume: Vec<String>,
    #[command(flatten)]
    options: DosingOptions,
    #[command(flatten)]
    finish: FinishOption,
    /// Suck back so much after the dose; the next one repays it
    #[arg(long, value_name = "VOLUME", value_parser = units::volume_ml, help_heading = "Amount and speed")]
    retract: Option<f64>,
    #[command(flatten)]
    by_weight: ByWeightOptions,
    #[command(flatten)]
    balance: BalanceOptions,
    #[command(flatten)]
    batch: BatchOptions,
}

impl DoseArgs {
    /// The first word in place of the volume, if it looks like a command rather than a number.
    pub(crate) fn mistyped_command(&self) -> Option<&str> {
        self.volume.first().map(String::as_str).filter(|word| is_name(word))
    }

    /// The command to run if this one fails.
    pub(crate) fn on_fail(&self) -> Option<OnFail> {
        self.options.on_fail()
    }

    pub(crate) fn run(&self) -> Result<(), Failure> {
        let asked = asked(&self.volume)?;
        let options = &self.options;
        options.check_files()?;
        let schedule = self.batch.schedule()?;
        if let Some(schedule) = &schedule {
            batch::refuse_files(options, schedule.count())?;
        }
        self.by_weight.check(&self.balance)?;
        if self.by_weight.until_scale && schedule.is_some() {
            return Err(Failure::refused(
                "--until-scale makes one dose; a batch by weight is one command for each vessel",
            ));
        }
        let bench = options.bench()?;
        let request = options
            .request(Purpose::Dose, &asked, &bench)?
            .with_finish(self.finish.finish())
            .with_retraction(self.retract);
        if self.by_weight.until_scale {
            let typed = options.typed(&asked);
            return by_weight::run(&bench, request, &typed, &self.by_weight, &self.balance, options);
        }
        match schedule {
            Some(schedule) => {
                batch::run(&bench, request, &options.typed(&asked), schedule, self.batch.every, options)
            }
            None => delivery::run_one(&bench, request, &options.typed(&asked), options),
        }
    }
}
