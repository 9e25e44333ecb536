//! The short help: one list of options without headings, and of a dose's options the ten that are used most.

use clap::Command;

/// The options of a dose that the short help lists, by clap's ids.
const FREQUENT: [&str; 10] =
    ["rate", "speed", "within", "smooth", "repeat", "every", "pump", "dry_run", "format", "verbose"];

/// Makes the help of the command and of each of its subcommands short.
pub(crate) fn brief(command: Command) -> Command {
    flat(command.mut_args(|arg| {
        let is_hidden = !arg.is_positional() && !FREQUENT.contains(&arg.get_id().as_str());
        arg.hide_short_help(is_hidden)
    }))
}

/// Leaves the headings out.
fn flat(command: Command) -> Command {
    command.mut_args(|arg| arg.help_heading(None)).mut_subcommands(flat)
}
