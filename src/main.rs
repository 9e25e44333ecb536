//! `dose`: the command. Everything that is not about typing and printing is in `pump-bench`.

mod advice;
mod arguments;
#[cfg(feature = "serve")]
mod asking;
mod cli;
mod commands;
mod failure;
mod help;
mod interrupt;
mod on_fail;
mod options;
mod outputs;
mod progress;
mod refusals;
mod shown;
mod terminal;
mod told_commands;
mod user_name;
mod warned;

use std::ffi::OsString;
use std::process::ExitCode;

use clap::error::ErrorKind;
use clap::{ArgMatches, FromArgMatches};

use cli::Cli;
use failure::Failure;

fn main() -> ExitCode {
    #[cfg(unix)]
    interrupt::outlive_file_limits();
    progress::supervised::begin();
    let words: Vec<OsString> = std::env::args_os().collect();
    let json = arguments::asks_for_json(&words);
    let (ended, on_fail) = match parse(words) {
        Ok(Parsed::Here(cli)) => (cli.run(), cli.on_fail()),
        Ok(Parsed::Asked(code)) => return code,
        Err(Unparsed::Refused(failure)) => (Err(failure), None),
        Err(Unparsed::Clap(error)) if json && error.use_stderr() => (Err(refusals::unparsed(&error)), None),
        Err(Unparsed::Clap(error)) => {
            // Nowhere is left to complain to if this fails.
            let _ = error.print();
            return if error.use_stderr() { ExitCode::from(2) } else { ExitCode::SUCCESS };
        }
    };
    match ended {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            // The error stays the last line of standard error.
            on_fail.iter().for_each(|on_fail| {
                progress::supervised::ends();
                on_fail.tell(&failure);
            });
            if !json {
                progress::supervised::failed(&failure.json());
            }
            terminal::say_error(&failure, json);
            ExitCode::from(failure.exit_code())
        }
    }
}

/// Why nothing was run.
enum Unparsed {
    Refused(Failure),
    /// Help that was asked for, or what clap itself refuses.
    Clap(clap::Error),
}

/// A command line that was understood.
enum Parsed {
    /// The command is carried out here.
    Here(Box<Cli>),
    /// The running service has carried it out, with this exit code.
    #[cfg_attr(not(feature = "serve"), expect(dead_code, reason = "nobody is asked without the service"))]
    Asked(ExitCode),
}

/// The words after the program's name.
#[cfg(feature = "serve")]
fn typed(words: &[OsString]) -> Vec<String> {
    words.iter().skip(1).map(|word| word.to_string_lossy().into_owned()).collect()
}

/// Clap's definitions with what it adds itself.
fn built() -> clap::Command {
    let mut definitions = cli::command();
    definitions.build();
    definitions
}

fn parse(words: Vec<OsString>) -> Result<Parsed, Unparsed> {
    #[cfg(feature = "serve")]
    let (typed, json) = (typed(&words), arguments::asks_for_json(&words));
    // Definitions take a megabyte, so none stays: a service has a process for each motion.
    let arranged = arguments::arrange(words.into_iter(), &built()).map_err(Unparsed::Refused)?;
    let command = || if arranged.brief { help::brief(cli::command()) } else { cli::command() };
    let matches = command().try_get_matches_from(&arranged.words);
    let matches = matches.and_then(|typed| arguments::with_defaults(command, &arranged.words, typed));
    let read = |matches: ArgMatches| {
        told_commands::note(&matches, cli::command);
        let cli = Cli::from_arg_matches(&matches)?;
        // A command that cannot be understood is refused here, before anybody is asked.
        #[cfg(feature = "serve")]
        if let Some(code) = asking::ask(&matches, &typed, json) {
            return Ok(Parsed::Asked(code));
        }
        Ok(Parsed::Here(Box::new(cli)))
    };
    matches.and_then(read).map_err(|error| {
        let misplaced = (error.kind() == ErrorKind::UnknownArgument)
            .then(|| refusals::misplaced(&error, &arranged.path, &built()))
            .flatten();
        misplaced.map_or(Unparsed::Clap(error), Unparsed::Refused)
    })
}
