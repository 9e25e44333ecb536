//! `dose calibrate verify`: doses of one volume, their errors, and whether those are allowed.

use std::path::PathBuf;

use clap::Args;
use pump_bench::calibration::{Tolerance, Verification, Weighing, readings_of_csv};
use pump_bench::report::ErrorKind;
use pump_bench::units::{self, Amount, count};
use pump_bench::{Bench, DoseRequest, Session};

use super::answers::{Answer, example, volume_ml};
use super::reading::{in_table, read};
use super::scale::Scale;
use crate::commands::delivery::deliver;
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::on_fail::OnFail;
use crate::options::balance::BalanceOptions;
use crate::options::bench::BenchOptions;
use crate::options::fluid::FluidOptions;
use crate::options::report::FormatOption;
use crate::options::speed::CruiseOptions;
use crate::options::unattended::OnFailOption;
use crate::terminal::{noted, print_json, say, tell, warn_of_pump};
use crate::warned::Warned;

/// Doses that ISO 8655-6 asks for.
const DOSES: u32 = 10;

#[derive(Debug, Args)]
pub(super) struct VerifyArgs {
    /// Volume of the dose, with its unit
    #[arg(long = "volume", value_name = "VOLUME", value_parser = units::amount)]
    nominal: Amount,
    /// Number of doses [default: 10]
    #[arg(long, value_name = "N", value_parser = count("number of doses", 2..=1000), conflicts_with = "from")]
    runs: Option<u32>,
    /// Systematic error allowed, as 0.6% [default: ISO 8655-5's for 10 mL]
    #[arg(long, value_name = "PERCENT", value_parser = percent)]
    systematic: Option<f64>,
    /// Random error (CV) allowed, as 0.2% [default: ISO 8655-5's for 10 mL]
    #[arg(long, value_name = "PERCENT", value_parser = percent)]
    random: Option<f64>,
    /// Table of doses that were made before, CSV: mass_g or volume_ml, temperature_degc
    #[arg(long, value_name = "FILE")]
    #[arg(conflicts_with_all = ["port", "configure", "rate", "speed", "within"])]
    from: Option<PathBuf>,
    #[command(flatten)]
    cruise: CruiseOptions,
    #[command(flatten)]
    balance: BalanceOptions,
    #[command(flatten)]
    fluid: FluidOptions,
    #[command(flatten)]
    bench: BenchOptions,
    #[command(flatten)]
    on_fail: OnFailOption,
    #[command(flatten)]
    format: FormatOption,
}

impl VerifyArgs {
    /// The command to run if this one fails; none for a table of doses.
    pub(super) fn on_fail(&self) -> Option<OnFail> {
        if self.from.is_some() { None } else { self.on_fail.named(&self.bench.pump) }
    }

    pub(super) fn run(&self) -> Result<(), Failure> {
        let mut file = self.bench.pump.file()?;
        self.fluid.change(&mut file)?;
        let bench = self.bench.bench_of(file)?;
        let nominal_ml = Weighing::of(bench.file()).amount_ml(self.nominal)?;
        if nominal_ml < 0.0 {
            return Err(Failure::refused("--volume is negative; verify forward doses"));
        }
        let tolerance = self.tolerance(nominal_ml)?;
        if self.from.is_some() && self.balance.is_given() {
            return Err(Failure::refused("--from has the readings of a table; leave out the balance"));
        }
        if let Some(path) = &self.from {
            let volumes_ml = in_table(path, readings_of_csv(&read(path)?, &Weighing::of(bench.file())))?;
            return self.judge(Verification::of(nominal_ml, volumes_ml, tolerance)?);
        }
        warn_of_pump(&bench);
        let mut session = bench.session()?;
        let verified = match self.doses(&bench, &mut session, nominal_ml) {
            Ok(Some(volumes_ml)) => Verification::of(nominal_ml, volumes_ml, tolerance)
                .map_err(Failure::from)
                .and_then(|found| self.judge(found)),
            Ok(None) => tell("nothing was verified\n"),
            Err(failure) => Err(failure.with("; nothing is kept of the readings")),
        };
        verified.map_err(|failure| failure.of_session(&session))
    }

    /// Reports the errors of the doses. Errors beyond the tolerance are a failure.
    fn judge(&self, found: Verification) -> Result<(), Failure> {
        if self.format.json() {
            print_json(&(found.json() + "\n"))?;
        } else {
            tell(&found.text())?;
        }
        if found.passed {
            return Ok(());
        }
        let mean_is_allowed = found.systematic_percent.abs() <= found.tolerance.systematic_percent;
        let way = match mean_is_allowed {
            true => {
                "their mean is, and they scatter: look for air in the line, a worn tube and drops at the nozzle"
            }
            false => "calibrate, `dose calibrate run`",
        };
        Err(Failure::failed(ErrorKind::Tolerance, format!("the doses are not within their tolerance; {way}")))
    }

    fn tolerance(&self, nominal_ml: f64) -> Result<Tolerance, Failure> {
        let standard = Tolerance::of_standard(nominal_ml);
        let either = |given: Option<f64>, of: fn(Tolerance) -> f64| given.or(standard.map(of));
        let systematic = either(self.systematic, |standard| standard.systematic_percent);
        let random = either(self.random, |standard| standard.random_percent);
        match (systematic, random) {
            (Some(systematic_percent), Some(random_percent)) => {
                Ok(Tolerance { systematic_percent, random_percent })
            }
            _ => Err(Failure::refused(format!(
                "for {nominal_ml} mL no standard's tolerance is known here (ISO 8655-5's is for 10 mL); give \
                 --systematic and --random, as 0.6% and 0.2%"
            ))),
        }
    }

    /// Makes the doses and asks for what arrived, mL. None if the person left.
    fn doses(
        &self,
        bench: &Bench,
        session: &mut Session<'_>,
        nominal_ml: f64,
    ) -> Result<Option<Vec<f64>>, Failure> {
        let (mut scale, interrupt) = (Scale::of(bench, &self.balance)?, Interrupt::watch()?);
        let all = self.runs.unwrap_or(DOSES);
        let request = DoseRequest::dose(nominal_ml).with_cruise(self.cruise.cruise()?);
        let weighing = Weighing::of(bench.file());
        let degc = weighing.fluid.temperature_degc;
        let mut volumes_ml = Vec::new();
        while volumes_ml.len() < all as usize {
            let title = format!("dose {} of {all}", volumes_ml.len() + 1);
            scale.before()?;
            let prepared = session.prepare(request);
            let prepared = noted(session, prepared)?;
            say(&format!("{title}: moving\n"));
            let json = self.format.json();
            let (delivered, signal) =
                deliver(bench, session, &prepared, &interrupt, json, &mut Warned::default())?;
            if !delivered.completed {
                return Err(Failure::stopped(
                    signal.unwrap_or(0),
                    true,
                    "stopped by the user in a dose; `dose resume` makes the rest, `dose accept` leaves it",
                ));
            }
            match scale.reading(&title, &example(&weighing, nominal_ml), session, &interrupt)? {
                Answer::Read(reading, _) => {
                    // The carry that a dose repays or leaves is no error of the pump.
                    let carried_ml = prepared.plan.planned_ml() - nominal_ml;
                    volumes_ml.push(volume_ml(reading, &weighing, degc)? - carried_ml);
                }
                Answer::Redo => {}
                Answer::Quit => return Ok(None),
            }
        }
        Ok(Some(volumes_ml))
    }
}

/// Reads a percentage.
fn percent(text: &str) -> Result<f64, String> {
    let wrong = || format!("`{text}` is no percentage; write for example 0.6%");
    let number = text.strip_suffix('%').ok_or_else(wrong)?;
    let value: f64 = number.trim().parse().map_err(|_| wrong())?;
    if value > 0.0 && value <= 100.0 {
        Ok(value)
    } else {
        Err(format!("`{text}` is not between 0% and 100%"))
    }
}
