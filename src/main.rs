//! `dose`: the command. Everything that is not about typing and printing is in `pump-bench`.

mod advice;
mod arguments;
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
mod warned;

use std::ffi::OsString;
use std::process::ExitCode;

use clap::error::ErrorKind;
use clap::{ArgMatches, FromArgMatches};

use cli::Cli;
use failure::Failure;

fn main() -> ExitCode {
    let words: Vec<OsString> = std::env::args_os().collect();
    let json = arguments::asks_for_json(&words);
    let (ended, on_fail) = match parse(words) {
        Ok(cli) => (cli.run(), cli.on_fail()),
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
            on_fail.iter().for_each(|on_fail| on_fail.tell(&failure));
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

fn parse(words: Vec<OsString>) -> Result<Cli, Unparsed> {
    let mut definitions = cli::command();
    definitions.build();
    let arranged = arguments::arrange(words.into_iter(), &definitions).map_err(Unparsed::Refused)?;
    let command = if arranged.brief { help::brief(cli::command()) } else { cli::command() };
    let matches = command.clone().try_get_matches_from(&arranged.words);
    let matches = matches.and_then(|typed| arguments::with_defaults(command, &arranged.words, typed));
    let read = |matches: ArgMatches| {
        told_commands::note(&matches, cli::command());
        Cli::from_arg_matches(&matches)
    };
    matches.and_then(read).map_err(|error| {
        let misplaced = (error.kind() == ErrorKind::UnknownArgument)
            .then(|| refusals::misplaced(&error, &arranged.path, &definitions))
            .flatten();
        misplaced.map_or(Unparsed::Clap(error), Unparsed::Refused)
    })
}
