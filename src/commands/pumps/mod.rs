//! `dose pumps`: built-in pumps and pump files.

mod check;
mod new;
mod own_motor;
mod show;
mod site;

use clap::{Args, Subcommand};
use pump_bench::catalogue::BUILT_IN;
use pump_bench::report::ShownPump;

use crate::failure::Failure;
use crate::options::pump::ConfigOption;
use crate::terminal::tell;

#[derive(Debug, Args)]
pub(crate) struct PumpsArgs {
    #[command(subcommand)]
    command: Option<PumpsCommand>,
    #[command(flatten)]
    config: ConfigOption,
}

#[derive(Debug, Args)]
struct ListArgs {
    #[command(flatten)]
    config: ConfigOption,
}

#[derive(Debug, Subcommand)]
enum PumpsCommand {
    /// List the pumps of the configuration and the built-in pumps
    List(ListArgs),
    /// Print a pump as a pump file, or with --format rust as constants for firmware
    Show(show::ShowArgs),
    /// Write a pump file from a drawing
    New(Box<new::NewArgs>),
    /// Check a pump file and say what it gives
    Check(check::CheckArgs),
}

impl PumpsArgs {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        match &self.command {
            None => list(&self.config),
            Some(PumpsCommand::List(args)) => list(&args.config),
            Some(PumpsCommand::Show(args)) => args.run(),
            Some(PumpsCommand::New(args)) => args.run(),
            Some(PumpsCommand::Check(args)) => args.run(),
        }
    }
}

/// Lists the pumps of the configuration with their files, then the built-in ones.
fn list(config: &ConfigOption) -> Result<(), Failure> {
    let configured: String = ShownPump::all(&config.config()?).iter().map(ShownPump::line).collect();
    tell(&(configured + &BUILT_IN.map(|(name, what)| format!("{name:<24}{what}\n")).concat()))
}
