//! `dose calibrate`: what the pump really delivers.

mod answers;
mod course;
mod guided;
mod last;
mod list;
mod phase;
mod reading;
mod run;
mod scale;
mod use_version;
mod verify;

use clap::{Args, Subcommand};

use crate::failure::Failure;
use crate::on_fail::OnFail;

#[derive(Debug, Args)]
pub(crate) struct CalibrateArgs {
    #[command(subcommand)]
    command: Option<CalibrateCommand>,
    #[command(flatten)]
    list: list::ListArgs,
}

#[derive(Debug, Subcommand)]
enum CalibrateCommand {
    /// Weigh runs, or read them from a table, and use what they show from now on
    Run(run::RunArgs),
    /// Calibrate by the dose just made: `dose calibrate last 23.8g`
    Last(last::LastArgs),
    /// Repeat a dose and report its errors as ISO 8655-6 does
    ///
    /// The report gives the systematic and the random error. The exit code is 1 if they are too large.
    Verify(verify::VerifyArgs),
    /// Find roller volume, engagement angle and zero from short doses at known start angles
    Phase(phase::PhaseArgs),
    /// List the calibrations of this pump
    List(list::ListArgs),
    /// Use another calibration from now on
    Use(use_version::UseArgs),
}

impl CalibrateArgs {
    /// The command to run if this one fails; none for a command that makes no dose.
    pub(crate) fn on_fail(&self) -> Option<OnFail> {
        match &self.command {
            Some(CalibrateCommand::Run(args)) => args.on_fail(),
            Some(CalibrateCommand::Verify(args)) => args.on_fail(),
            _ => None,
        }
    }

    pub(crate) fn run(&self) -> Result<(), Failure> {
        match &self.command {
            Some(CalibrateCommand::Run(args)) => args.run(),
            Some(CalibrateCommand::Last(args)) => args.run(),
            Some(CalibrateCommand::Verify(args)) => args.run(),
            Some(CalibrateCommand::Phase(args)) => args.run(),
            Some(CalibrateCommand::List(args)) => args.run(),
            None => self.list.run(),
            Some(CalibrateCommand::Use(args)) => args.run(),
        }
    }
}
