//! `dose pumps`: built-in pumps and pump files.

mod check;
mod list;
mod new;
mod new_bought;
mod own_motor;
mod remove;
mod show;
pub(crate) mod site;

use clap::{Args, Subcommand};

use crate::failure::Failure;
use crate::options::pump::ConfigOption;

#[derive(Debug, Args)]
pub(crate) struct PumpsArgs {
    #[command(subcommand)]
    command: Option<PumpsCommand>,
    #[command(flatten)]
    config: ConfigOption,
}

#[derive(Debug, Subcommand)]
enum PumpsCommand {
    /// List the pumps of the configuration and the built-in pumps, or with --catalogue bought heads
    List(list::ListArgs),
    /// Print a pump as a pump file, or with --format rust as constants for firmware
    Show(show::ShowArgs),
    /// Write a pump file from a drawing, from the catalogue or from a volume per revolution
    New(Box<new::NewArgs>),
    /// Check a pump file and say what it gives
    Check(check::CheckArgs),
    /// Remove a pump of the configuration, with its file; its record stays
    Remove(remove::RemoveArgs),
}

impl PumpsArgs {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        match &self.command {
            None => list::list_pumps(&self.config),
            Some(PumpsCommand::List(args)) => args.run(),
            Some(PumpsCommand::Show(args)) => args.run(),
            Some(PumpsCommand::New(args)) => args.run(),
            Some(PumpsCommand::Check(args)) => args.run(),
            Some(PumpsCommand::Remove(args)) => args.run(),
        }
    }
}
