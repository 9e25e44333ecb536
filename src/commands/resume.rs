//! `dose resume`: the rest of an unfinished dose.

use clap::Args;
use pump_bench::{DoseError, DoseRequest};

use super::accept::NamedDose;
use super::by_weight;
use super::delivery::{Said, deliver, find_angle_of_rest, report};
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::on_fail::OnFail;
use crate::options::balance::{BalanceOptions, ByWeightOptions};
use crate::options::bench::BenchOptions;
use crate::options::finish::FinishOption;
use crate::options::fluid::FluidOptions;
use crate::options::limits::PressureOptions;
use crate::options::report::{FormatOption, VerboseOption};
use crate::options::speed::{CruiseOptions, RampsOption};
use crate::options::unattended::{OnFailOption, has_no_terminal};
use crate::terminal::{noted, say, tell, warn};
use crate::warned::Warned;

#[derive(Debug, Args)]
pub(crate) struct ResumeArgs {
    #[command(flatten)]
    named: NamedDose,
    #[command(flatten)]
    cruise: CruiseOptions,
    /// Let the speed follow the rollers for a smooth flow
    #[arg(long_help = "Let the speed follow the rollers' angle, for a flow as smooth as the limits allow.")]
    #[arg(long, help_heading = "Amount and speed")]
    smooth: bool,
    #[command(flatten)]
    finish: FinishOption,
    #[command(flatten)]
    ramps: RampsOption,
    #[command(flatten)]
    fluid: FluidOptions,
    #[command(flatten)]
    limits: PressureOptions,
    #[command(flatten)]
    by_weight: ByWeightOptions,
    #[command(flatten)]
    balance: BalanceOptions,
    #[command(flatten)]
    bench: BenchOptions,
    /// Plan and predict the rest; move nothing, record nothing
    #[arg(long, help_heading = "Motor")]
    dry_run: bool,
    #[command(flatten)]
    on_fail: OnFailOption,
    #[command(flatten)]
    format: FormatOption,
    #[command(flatten)]
    verbose: VerboseOption,
}

impl ResumeArgs {
    /// The command to run if this one fails; none for a dry run.
    pub(crate) fn on_fail(&self) -> Option<OnFail> {
        if self.dry_run { None } else { self.on_fail.or_configured(&self.bench.pump, has_no_terminal()) }
    }

    pub(crate) fn run(&self) -> Result<(), Failure> {
        self.by_weight.check(&self.balance)?;
        let mut file = self.bench.pump.file()?;
        self.limits.change(&mut file)?;
        self.fluid.change(&mut file)?;
        let bench = self.bench.bench_of(file)?;
        let request = DoseRequest::dose(0.0)
            .with_cruise(self.cruise.cruise()?)
            .with_smooth(self.smooth)
            .with_ramps(self.ramps.ramps())
            .with_finish(self.finish.finish())
            .with_pressures(self.limits.pressures(bench.file()));
        let json = self.format.json();
        let said = Said { json, verbose: self.verbose.verbose, asked: None };
        if self.by_weight.until_scale {
            if self.dry_run {
                return Err(Failure::refused(
                    "a rest by weight is planned from what the balance shows; leave out --dry-run or --until-scale",
                ));
            }
            self.named.check(&bench)?;
            return by_weight::resume(&bench, request, &self.by_weight, &self.balance, &said);
        }
        if self.dry_run {
            self.named.check(&bench)?;
            let prepared = bench.prepare_rest(request)?;
            return report(&bench, &prepared, None, &said);
        }
        let interrupt = Interrupt::watch()?;
        let mut session = bench.session()?;
        self.named.check(&bench)?;
        find_angle_of_rest(&mut session, &interrupt)?;
        let prepared = match session.prepare_rest(request) {
            // The dose is done, as was asked.
            Err(done @ DoseError::WasFinished) => {
                warn(&session.notes());
                return finished(&done, json);
            }
            prepared => {
                noted(&mut session, prepared).map_err(|error| Failure::from(error).of_session(&session))?
            }
        };
        let delivered = deliver(&bench, &mut session, &prepared, &interrupt, json, &mut Warned::default())?;
        report(&bench, &prepared, Some(delivered), &said)
    }
}

/// Tells that the device has finished the dose: a person on standard output, and beside the reports for a program.
fn finished(done: &DoseError, json: bool) -> Result<(), Failure> {
    let text = format!("{done}\n");
    if json {
        say(&text);
        return Ok(());
    }
    tell(&text)
}
