//! `dose safety`: the safety limits of a pump, the order to one to stand, and the word of a person that it may go on.

mod clear;
mod stand;
mod vessel;

use clap::{Args, Subcommand};
use pump_bench::report::Status;

use self::clear::ClearArgs;
use self::stand::StandArgs;
use crate::advice;
use crate::commands::record::{rows_of_all, tell_rows};
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
    /// Say it of every pump that the configuration names, a row each
    #[arg(long)]
    all: bool,
    #[command(flatten)]
    format: FormatOption,
}

#[derive(Debug, Subcommand)]
enum SafetyCommand {
    /// Let a pump go on that stands
    Clear(ClearArgs),
    /// Put a pump to stand: every motion is refused until it is cleared
    Stand(StandArgs),
}

impl SafetyArgs {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        match &self.command {
            Some(SafetyCommand::Clear(args)) => return args.run(),
            Some(SafetyCommand::Stand(args)) => return args.run(),
            None => {}
        }
        if self.all {
            let rows = rows_of_all(&self.record)?;
            return tell_rows(&rows, self.format.json(), |row, width| row.safety_text(width, advice::words));
        }
        let status = Status::of(&self.record.bench()?)?;
        if self.format.json() {
            print_json(&(status.json() + "\n"))
        } else {
            tell(&format!("{} ({})\n{}", status.pump, status.driver, status.safety.text(advice::words)))
        }
    }
}
