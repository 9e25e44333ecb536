//! Refusals of words that the parser does not take: what was meant, and which command has it.

use std::error::Error;
use std::ffi::OsString;

use clap::error::{ContextKind, ContextValue};
use clap::{Arg, Command};
use pump_bench::units::QuantityError;

use crate::advice::Advised;
use crate::failure::Failure;

/// True for a word in place of a volume that looks like a command rather than a number.
pub(crate) fn is_name(word: &str) -> bool {
    let is_number = ["nan", "inf"].iter().any(|name| word.to_lowercase().starts_with(name));
    !is_number && word.starts_with(char::is_alphabetic)
}

/// Refuses words before a command. A volume and a command are never half obeyed.
pub(crate) fn beside_a_command(words: &[OsString], command: &Command, root: &Command) -> Failure {
    let words: Vec<_> = words.iter().map(|word| word.to_string_lossy().replace('\u{2212}', "-")).collect();
    match words.first() {
        Some(word) if is_name(word) && command.find_subcommand(word).is_some() => {
            let meant = format!("dose {} {word}", command.get_name());
            Failure::refused(format!("unknown command `{word}`; did you mean `{meant}`?"))
                .value(word)
                .allowed(meant)
        }
        Some(word) if is_name(word) => unknown(word, root),
        _ => {
            let words = words.join(" ");
            let message = format!("`{words}` and a command together; give either a volume or a command");
            Failure::refused(message).value(words)
        }
    }
}

/// Refuses a word that is neither a volume nor a command.
pub(crate) fn unknown(word: &str, root: &Command) -> Failure {
    let commands: Vec<&str> =
        root.get_subcommands().map(Command::get_name).filter(|command| *command != "help").collect();
    let distance = |command: &&&str| strsim::damerau_levenshtein(word, command);
    let all = commands.join(", ");
    // Two letters of a word of four or five are another word.
    let near = |command: &&&str| distance(command) <= 2 && 3 * distance(command) <= word.chars().count();
    let message = match commands.iter().filter(near).min_by_key(distance) {
        _ if word == root.get_name() => format!("a dose needs no command: `{word} 25mL` doses 25 mL"),
        Some(command) => format!("unknown command `{word}`; did you mean `dose {command}`?"),
        None => format!("`{word}` is neither a volume, as 25mL, nor a command: {all}"),
    };
    Failure::refused(message).value(word).allowed(all)
}

/// The refusal of what clap refuses, for a program. Its facts are clap's own, or those of the quantity inside.
pub(crate) fn unparsed(error: &clap::Error) -> Failure {
    let text = error.to_string();
    let lines = text.lines().map(str::trim);
    let about =
        lines.take_while(|line| !line.starts_with("Usage:") && !line.starts_with("For more information"));
    let words: Vec<_> = about.filter(|line| !line.is_empty()).collect();
    let message = sentences(&words).trim_start_matches("error: ").to_owned();
    let source = error.source();
    let advised = source.and_then(|source| source.downcast_ref::<Advised>()).map(|advised| &advised.0);
    let quantity = advised.or(source.and_then(|source| source.downcast_ref::<QuantityError>()));
    if let Some(quantity) = quantity {
        return Failure::of(quantity).saying(message);
    }
    let of = |kind| error.get(kind).map(listed);
    let value = [ContextKind::InvalidValue, ContextKind::InvalidSubcommand, ContextKind::InvalidArg];
    let allowed = [ContextKind::ValidValue, ContextKind::ValidSubcommand];
    let refused = Failure::refused(message);
    let refused = value.into_iter().find_map(of).into_iter().fold(refused, Failure::value);
    allowed.into_iter().find_map(of).into_iter().fold(refused, Failure::allowed)
}

/// Joins the lines of clap's message: those of a list by spaces, and sentences by semicolons.
fn sentences(lines: &[&str]) -> String {
    let mut text = String::new();
    for line in lines {
        if !text.is_empty() {
            text.push_str(if text.ends_with(':') { " " } else { "; " });
        }
        text.push_str(line);
    }
    text
}

/// Lists a value of clap's.
fn listed(value: &ContextValue) -> String {
    match value {
        ContextValue::Strings(words) => words.join(", "),
        // clap shows an option with the name of its value.
        ContextValue::String(word) => word.split(" <").next().unwrap_or_default().to_owned(),
        other => other.to_string(),
    }
}

/// The refusal of an option that other commands have; none if no command has it.
pub(crate) fn misplaced(error: &clap::Error, path: &[String], root: &Command) -> Option<Failure> {
    let ContextValue::String(option) = error.get(ContextKind::InvalidArg)? else { return None };
    let option = option.split(['=', ' ']).next()?;
    let mut owners = Vec::new();
    owners_of(root, option, "dose", &mut owners);
    let others = match &owners[..] {
        [] => return None,
        [owner] => format!("it belongs to {owner}"),
        [first, second] => format!("{first} and {second} do"),
        [first, second, third] => format!("{first}, {second} and {third} do"),
        [first, second, more @ ..] => {
            format!("leave it out; {first}, {second} and {} other commands take it", more.len())
        }
    };
    let command = [&["dose".to_owned()], path].concat().join(" ");
    Some(Failure::refused(format!("`{command}` takes no {option}; {others}")).value(option))
}

/// Collects the commands that list an option.
fn owners_of(command: &Command, option: &str, name: &str, owners: &mut Vec<String>) {
    if command.get_arguments().any(|arg| !arg.is_hide_set() && is_named(arg, option)) {
        owners.push(format!("`{name}`"));
    }
    for subcommand in command.get_subcommands().filter(|subcommand| subcommand.get_name() != "help") {
        owners_of(subcommand, option, &format!("{name} {}", subcommand.get_name()), owners);
    }
}

/// True if an option has this definition.
pub(crate) fn is_named(arg: &Arg, option: &str) -> bool {
    match option.strip_prefix("--") {
        Some(long) => arg.get_long() == Some(long),
        None => arg.get_short().is_some_and(|short| option.strip_prefix('-') == Some(&short.to_string())),
    }
}
