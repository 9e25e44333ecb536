//! The commands by name, and what a command line without one means: a dose.

use clap::builder::ValueParser;
use clap::{Arg, CommandFactory, Parser, Subcommand};

use crate::commands::accept::AcceptArgs;
use crate::commands::calibrate::CalibrateArgs;
use crate::commands::completions::CompletionsArgs;
use crate::commands::config::ConfigArgs;
use crate::commands::dose::DoseArgs;
use crate::commands::home::HomeArgs;
use crate::commands::identify::IdentifyArgs;
#[cfg(feature = "man")]
use crate::commands::man_pages::ManPagesArgs;
use crate::commands::prime::PrimeArgs;
use crate::commands::pumps::PumpsArgs;
use crate::commands::purge::PurgeArgs;
use crate::commands::record::backup::{BackupArgs, RestoreArgs};
use crate::commands::record::log::LogArgs;
use crate::commands::record::status::StatusArgs;
use crate::commands::release::ReleaseArgs;
use crate::commands::resume::ResumeArgs;
use crate::commands::run::RunArgs;
use crate::commands::safety::{SafetyArgs, VesselArgs};
use crate::commands::serve::ServeArgs;
use crate::commands::setup::SetupArgs;
use crate::commands::simulate::SimulateArgs;
use crate::commands::size::SizeArgs;
use crate::commands::tube::TubeArgs;
use crate::failure::Failure;
use crate::on_fail::OnFail;
use crate::refusals::unknown;

const EXAMPLES: &str = "Examples:
  dose 25mL
  dose 0.5mL --start-angle 30deg+-1deg --dry-run
  dose 100mL --rate 600mL/min --plot dose.svg
  dose simulate --speed 100rpm --duration 10s --trace run.csv";

/// Doses with a peristaltic pump from the angle of its rollers
#[derive(Debug, Parser)]
#[command(
    name = "dose",
    version,
    override_usage = "dose [OPTIONS] <VOLUME>\n       dose [OPTIONS] <COMMAND>",
    after_help = "A volume has a unit, as 25mL, or is a mass, as 25g; a negative one runs in reverse.\n\
                  `dose --help` lists every option, `dose <COMMAND> -h` those of a command.",
    after_long_help = EXAMPLES
)]
pub(crate) struct Cli {
    #[command(flatten)]
    dose: DoseArgs,
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Set up a pump of your own, step by step
    Setup(Box<SetupArgs>),
    /// Fill the line before a dose; the carry stays as it is
    Prime(PrimeArgs),
    /// Empty the line; a negative volume runs back
    Purge(PurgeArgs),
    /// Run at a rate for a time, for a volume, or until stopped
    Run(RunArgs),
    /// Weigh what the pump delivers, so that doses are right
    Calibrate(CalibrateArgs),
    /// Find the constants of a line from measurements
    Identify(IdentifyArgs),
    /// Run the model at constant speed
    Simulate(SimulateArgs),
    /// Choose head, speed and hoses for a flow, and say the pressures
    Size(SizeArgs),
    /// Say where the rollers stand and what is unfinished
    Status(StatusArgs),
    /// List every dose with its time, and the totals by day and by tube
    Log(LogArgs),
    /// Make the rest of a dose that was stopped or cut off
    Resume(ResumeArgs),
    /// Accept a dose that was stopped or cut off as it is
    #[command(alias = "discard")]
    Accept(AcceptArgs),
    /// Let go of the rotor; its angle is less well known afterwards
    Release(ReleaseArgs),
    /// Say what the tube has pumped, or that it was replaced
    Tube(TubeArgs),
    /// Say what the safety limits leave, or clear the pump
    Safety(SafetyArgs),
    /// Say that the receiving vessel was emptied
    Vessel(VesselArgs),
    /// Find where the rollers stand, or say it
    Home(HomeArgs),
    /// Write all records into one file
    Backup(BackupArgs),
    /// Put the records of a backup in place; a record never turns back
    Restore(RestoreArgs),
    /// Share the pumps by a page, HTTP and a schedule
    Serve(ServeArgs),
    /// Print the completions of a shell
    Completions(CompletionsArgs),
    /// Write the manual's pages into a folder
    #[cfg(feature = "man")]
    #[command(hide = true)]
    ManPages(ManPagesArgs),
    /// List, show, check and make pump files
    Pumps(PumpsArgs),
    /// Say which pumps are known by name, and where the records are
    Config(ConfigArgs),
}

/// Clap's definitions of all commands. Pump and record may be named to each of them, as their environment variables are
/// there for each; a command that needs neither does not list them.
pub(crate) fn command() -> clap::Command {
    with_pump_and_record(Cli::command())
}

fn with_pump_and_record(command: clap::Command) -> clap::Command {
    let missing: Vec<Arg> = [("pump", "pump"), ("state_dir", "state-dir"), ("config", "config")]
        .into_iter()
        .filter(|(id, _)| !command.get_arguments().any(|arg| arg.get_id() == *id))
        .map(|(id, long)| Arg::new(id).long(long).value_parser(ValueParser::os_string()).hide(true))
        .collect();
    command.args(missing).mut_subcommands(with_pump_and_record)
}

impl Cli {
    /// The command of the shell to run if this one fails; none for a command that makes no dose.
    pub(crate) fn on_fail(&self) -> Option<OnFail> {
        match &self.command {
            None if self.dose.mistyped_command().is_some() => None,
            None => self.dose.on_fail(),
            Some(Command::Prime(args)) => args.on_fail(),
            Some(Command::Purge(args)) => args.on_fail(),
            Some(Command::Run(args)) => args.on_fail(),
            Some(Command::Resume(args)) => args.on_fail(),
            Some(Command::Calibrate(args)) => args.on_fail(),
            Some(_) => None,
        }
    }

    /// Runs the command.
    pub(crate) fn run(&self) -> Result<(), Failure> {
        match &self.command {
            None => {
                if let Some(word) = self.dose.mistyped_command() {
                    return Err(unknown(word, &Self::command()));
                }
                self.dose.run()
            }
            Some(Command::Setup(args)) => args.run(),
            Some(Command::Prime(args)) => args.run(),
            Some(Command::Purge(args)) => args.run(),
            Some(Command::Run(args)) => args.run(),
            Some(Command::Calibrate(args)) => args.run(),
            Some(Command::Identify(args)) => args.run(),
            Some(Command::Simulate(args)) => args.run(),
            Some(Command::Size(args)) => args.run(),
            Some(Command::Status(args)) => args.run(),
            Some(Command::Log(args)) => args.run(),
            Some(Command::Resume(args)) => args.run(),
            Some(Command::Accept(args)) => args.run(),
            Some(Command::Release(args)) => args.run(),
            Some(Command::Tube(args)) => args.run(),
            Some(Command::Safety(args)) => args.run(),
            Some(Command::Vessel(args)) => args.run(),
            Some(Command::Home(args)) => args.run(),
            Some(Command::Backup(args)) => args.run(),
            Some(Command::Restore(args)) => args.run(),
            Some(Command::Serve(args)) => args.run(),
            Some(Command::Completions(args)) => args.run(&mut Self::command()),
            #[cfg(feature = "man")]
            Some(Command::ManPages(args)) => args.run(Self::command()),
            Some(Command::Pumps(args)) => args.run(),
            Some(Command::Config(args)) => args.run(),
        }
    }
}
