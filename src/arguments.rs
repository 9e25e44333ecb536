//! The words of the command line, put into the order that the parser takes: the command, its options, the rest. So an
//! option may stand before the command or after it.

use std::ffi::OsString;

use clap::error::{ContextKind, ContextValue};
use clap::{Arg, Command};

use crate::failure::Failure;

/// The words in order.
pub(crate) struct Arranged {
    pub(crate) words: Vec<OsString>,
    /// The command and its subcommand, if there are any.
    pub(crate) path: Vec<String>,
    /// True if the short help is asked for.
    pub(crate) brief: bool,
}

/// Arranges the words of a command line. `root` is built: clap's own definitions say which options take a value.
pub(crate) fn arrange(words: impl Iterator<Item = OsString>, root: &Command) -> Result<Arranged, Failure> {
    let mut words = words.map(protect_minus).peekable();
    let program = words.next().unwrap_or_else(|| root.get_name().into());
    let (mut node, mut path) = (root, Vec::new());
    let (mut options, mut others): (Vec<OsString>, Vec<OsString>) = (Vec::new(), Vec::new());
    let mut brief = false;
    while let Some(word) = words.next() {
        let text = word.to_string_lossy().into_owned();
        if text == "--" {
            others.push(word);
            others.extend(words.by_ref());
        } else if text.starts_with('-') && text.len() > 1 {
            brief |= text == "-h";
            let next = words.peek().map(|next| next.to_string_lossy().into_owned());
            let takes_next = takes_value(node, root, &text, next.as_deref());
            options.push(word);
            options.extend(takes_next.then(|| words.next()).flatten());
        } else if let Some(command) = node.find_subcommand(&text) {
            if !others.is_empty() && node.get_name() == root.get_name() {
                return Err(beside_a_command(&others));
            }
            if others.is_empty() {
                path.push(command.get_name().to_owned());
                node = command;
            } else {
                others.push(word);
            }
        } else {
            others.push(word);
        }
    }
    let path_words = path.iter().map(OsString::from);
    let words = [program].into_iter().chain(path_words).chain(options).chain(others).collect();
    Ok(Arranged { words, path, brief })
}

/// A word that starts with `-` and a digit is a negative quantity and no option, wherever it stands. It passes the
/// parser with the minus sign U+2212 in place of the hyphen; quantities accept both.
fn protect_minus(word: OsString) -> OsString {
    match word.to_str().and_then(|text| text.strip_prefix('-')) {
        Some(rest) if rest.starts_with(|c: char| c.is_ascii_digit() || c == '.') => {
            format!("\u{2212}{rest}").into()
        }
        _ => word,
    }
}

/// True if the word after an option is its value. The definitions of the command that was named so far count first; an
/// option that stands before its command may be any command's.
fn takes_value(node: &Command, root: &Command, option: &str, next: Option<&str>) -> bool {
    // A value never begins with a hyphen: negative quantities are protected.
    let is_option = next.is_some_and(|next| next.starts_with('-') && next.len() > 1);
    if option.contains('=') || is_option {
        return false;
    }
    let mut found = Vec::new();
    defined(node, option, &mut found);
    if found.is_empty() {
        defined(root, option, &mut found);
    }
    let mut takes = found.iter().map(|arg| arg.get_action().takes_values());
    // One option is a flag of one command and has a value in another: before them it has none.
    let is_command = next.is_some_and(|next| node.find_subcommand(next).is_some());
    if is_command { !found.is_empty() && takes.all(|takes| takes) } else { takes.any(|takes| takes) }
}

/// Finds every definition of an option in a command and its subcommands.
fn defined<'a>(command: &'a Command, option: &str, found: &mut Vec<&'a Arg>) {
    found.extend(command.get_arguments().filter(|arg| is_named(arg, option)));
    for subcommand in command.get_subcommands().filter(|subcommand| subcommand.get_name() != "help") {
        defined(subcommand, option, found);
    }
}

fn is_named(arg: &Arg, option: &str) -> bool {
    match option.strip_prefix("--") {
        Some(long) => arg.get_long() == Some(long),
        None => arg.get_short().is_some_and(|short| option.strip_prefix('-') == Some(&short.to_string())),
    }
}

/// A volume before a command: never half obeyed.
fn beside_a_command(words: &[OsString]) -> Failure {
    let words: Vec<_> = words.iter().map(|word| word.to_string_lossy().replace('\u{2212}', "-")).collect();
    let words = words.join(" ");
    Failure::refused(format!("`{words}` and a command together; give either a volume or a command"))
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
        _ => "leave it out".to_owned(),
    };
    let command = [&["dose".to_owned()], path].concat().join(" ");
    Some(Failure::refused(format!("`{command}` takes no {option}; {others}")))
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
