//! `dose pumps`: built-in pumps and pump files.

mod check;
mod new;
mod show;

use clap::{Args, Subcommand};
use pump_bench::catalogue::BUILT_IN;

use crate::failure::Failure;
use crate::terminal::print;

#[derive(Debug, Args)]
pub(crate) struct PumpsArgs {
    #[command(subcommand)]
    command: Option<PumpsCommand>,
}

#[derive(Debug, Subcommand)]
enum PumpsCommand {
    /// List the built-in pumps
    List,
    /// Print a pump as a pump file, or with --format rust as constants for firmware
    Show(show::ShowArgs),
    /// Write a pump file from a drawing
    New(new::NewArgs),
    /// Check a pump file and say what it gives
    Check(check::CheckArgs),
}

impl PumpsArgs {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        match &self.command {
            None | Some(PumpsCommand::List) => {
                print(&BUILT_IN.map(|(name, what)| format!("{name:<24}{what}\n")).concat())
            }
            Some(PumpsCommand::Show(args)) => args.run(),
            Some(PumpsCommand::New(args)) => args.run(),
            Some(PumpsCommand::Check(args)) => args.run(),
        }
    }
}
