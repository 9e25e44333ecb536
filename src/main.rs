//! `dose`: the command. Everything that is not about typing and printing is in `pump-bench`.

mod commands;
mod failure;
mod interrupt;
mod options;
mod outputs;
mod volume;

use std::io::{self, Write};
use std::process::ExitCode;

use clap::{CommandFactory, FromArgMatches};

use commands::{calibrate, dose, home, identify, mark, pumps, simulate, status};
use failure::Failure;
use options::{Cli, Command, Options};

fn main() -> ExitCode {
    let arguments = std::env::args_os().map(volume::protect_minus);
    let matches = Cli::command().try_get_matches_from(arguments);
    let cli = match matches.and_then(|matches| Cli::from_arg_matches(&matches)) {
        Ok(cli) => cli,
        Err(error) => {
            let asked_for = !error.use_stderr();
            // Nowhere is left to complain to if this fails.
            let _ = error.print();
            return if asked_for { ExitCode::SUCCESS } else { ExitCode::from(2) };
        }
    };
    match dispatch(&cli) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            let (code, message) = match failure {
                Failure::Fault(message) => (1, message),
                Failure::Refused(message) => (2, message),
                Failure::Busy(message) => (3, message),
                Failure::Unfinished(message) => (4, message),
                Failure::Stopped(signal, message) => (128 + u8::try_from(signal).unwrap_or(0), message),
            };
            let _ = writeln!(io::stderr(), "error: {message}");
            ExitCode::from(code)
        }
    }
}

fn dispatch(cli: &Cli) -> Result<(), Failure> {
    let options = &cli.options;
    match &cli.command {
        None => dose::dose(&volume::only(&cli.volume)?, options),
        Some(_) if !cli.volume.is_empty() => Err(volume::beside_a_command(&cli.volume)),
        Some(Command::Prime { volume }) => dose::prime(&volume::only(volume)?, options),
        Some(Command::Purge { volume }) => dose::purge(&volume::only(volume)?, options),
        Some(Command::Simulate) => simulate::simulate(options),
        Some(Command::Resume) => dose::resume(options),
        Some(Command::Discard) => home::discard(options),
        Some(Command::Home { mark: true, mark_tolerance, .. }) => mark::mark(*mark_tolerance, options),
        Some(Command::Home { sensor: true, yes, .. }) => home::sensor(*yes, options),
        Some(Command::Home { set, .. }) => home::set(*set, options),
        Some(Command::Calibrate { command }) => calibrate::calibrate(command.as_ref(), options),
        Some(Command::Identify { command }) => identify::identify(command, options),
        Some(Command::Release) => home::release(options),
        // Required, so true.
        Some(Command::Tube { new: _ }) => home::new_tube(options),
        Some(Command::Status) => status::status(options),
        Some(Command::Completions { shell }) => completions(*shell, options),
        Some(Command::Pumps { command }) => pumps::pumps(command.as_ref(), options),
    }
}

/// Prints the completions of a shell.
fn completions(shell: clap_complete::Shell, options: &Options) -> Result<(), Failure> {
    options.accept_only("dose completions", &[])?;
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Cli::command(), "dose", &mut script);
    failure::print(&String::from_utf8_lossy(&script))
}
