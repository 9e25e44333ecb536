//! The command line: arguments in, exit code out.

mod args;
mod batch;
mod calibrate;
mod dose;
mod home;
mod identify;
mod interrupt;
mod mark;
mod new_pump;
mod outputs;
mod pumps;
mod simulate;
mod status;
mod volume;

use std::ffi::OsString;
use std::io::{self, ErrorKind, Write};
use std::process::ExitCode;

use clap::{CommandFactory, FromArgMatches};
use pump_dose::calibration::CalibrationError;
use pump_dose::{DoseError, DriveError, FolderError};

use args::{Cli, Command};

/// Why the command did not do what was asked.
pub(crate) enum Failure {
    /// Refused before anything moved: exit code 2.
    Refused(String),
    /// Another process holds the pump: exit code 3.
    Busy(String),
    /// An unfinished dose stands in the way: exit code 4.
    Unfinished(String),
    /// Something went wrong after motion began: exit code 1.
    Fault(String),
    /// The user stopped it by this signal, and what was delivered is recorded: exit code 128 + the signal's number.
    Stopped(i32, String),
}

impl Failure {
    /// A refusal with this message.
    pub(crate) fn refused(message: impl ToString) -> Self {
        Self::Refused(message.to_string())
    }

    /// The same failure with more to say.
    pub(crate) fn with(mut self, more: &str) -> Self {
        let (Self::Refused(message)
        | Self::Busy(message)
        | Self::Unfinished(message)
        | Self::Fault(message)
        | Self::Stopped(_, message)) = &mut self;
        message.push_str(more);
        self
    }
}

impl From<DoseError> for Failure {
    fn from(error: DoseError) -> Self {
        let message = error.to_string();
        match error {
            DoseError::Folder(FolderError::Busy { .. }) | DoseError::Connection(DriveError::Busy { .. }) => {
                Self::Busy(message)
            }
            DoseError::Unfinished { .. } => Self::Unfinished(message),
            DoseError::Drive { .. }
            | DoseError::NoIndex { .. }
            | DoseError::Retraction { .. }
            | DoseError::NotJournalled { .. }
            | DoseError::NotRecorded { .. } => Self::Fault(message),
            _ => Self::Refused(message),
        }
    }
}

impl From<CalibrationError> for Failure {
    fn from(error: CalibrationError) -> Self {
        Self::Refused(error.to_string())
    }
}

impl From<FolderError> for Failure {
    fn from(error: FolderError) -> Self {
        DoseError::from(error).into()
    }
}

/// Runs the command with these arguments, the program's name first.
pub(crate) fn run(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let arguments = arguments.into_iter().map(volume::protect_minus);
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
fn completions(shell: clap_complete::Shell, options: &args::Options) -> Result<(), Failure> {
    options.accept_only("dose completions", &[])?;
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Cli::command(), "dose", &mut script);
    print(&String::from_utf8_lossy(&script))
}

/// Prints to standard output. A reader that went away is no failure of the dose.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    match io::stdout().write_all(text.as_bytes()).and_then(|()| io::stdout().flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::Refused(format!("the report could not be printed: {error}")))
        }
        _ => Ok(()),
    }
}
