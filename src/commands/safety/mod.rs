//! `dose safety`: the safety limits of a pump, and the word of a person to one that stands at a limit.

mod clear;
mod vessel;

use clap::{Args, Subcommand};
use pump_bench::report::Status;

use self::clear::ClearArgs;
use crate::advice;
use crate::failure::Failure;
use crate::options::bench::RecordOptions;
use crate::options::report::FormatOption;
use crate::terminal::{print_json, tell};

pub(crate) use self::vessel::VesselArgs;

#[derive(Debug, Args)]
#[command(args_conflicts_with_subcommands = true)]
pub(crate) struct SafetyArgs {
    #[command(subcommand)]
    command: Option<SafetyCommand>,
    #[command(flatten)]
    record: RecordOptions,
    #[command(flatten)]
    format: FormatOption,
}

#[derive(Debug, Subcommand)]
enum SafetyCommand {
    /// Let a pump go on that stands at a safety limit
    Clear(ClearArgs),
}

impl SafetyArgs {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        if let Some(SafetyCommand::Clear(args)) = &self.command {
            return args.run();
        }
        let status = Status::of(&self.record.bench()?)?;
        if self.format.json() {
            print_json(&(status.json() + "\n"))
        } else {
            tell(&status.safety.text(advice::words))
        }
    }
}
