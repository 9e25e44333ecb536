//! The short help: one list of options without headings, and of a dose's options the ten that are used most.

use clap::{Arg, Command};

/// The options of a dose that the short help lists, by clap's ids.
const FREQUENT: [&str; 10] =
    ["rate", "speed", "within", "smooth", "repeat", "every", "pump", "dry_run", "format", "verbose"];

/// Makes the help of the command and of each of its subcommands short.
pub(crate) fn brief(command: Command) -> Command {
    let command = command.disable_help_subcommand(true).disable_version_flag(true);
    flat(command.mut_args(|arg| {
        let is_hidden = !FREQUENT.contains(&arg.get_id().as_str());
        arg.hide_short_help(is_hidden)
    }))
}

/// Leaves the headings and the meanings of the words to choose from out.
fn flat(command: Command) -> Command {
    let flat_arg = |arg: Arg| {
        let has_words = arg.get_action().takes_values();
        arg.help_heading(None).hide_possible_values(has_words)
    };
    command.mut_args(flat_arg).mut_subcommands(flat)
}
