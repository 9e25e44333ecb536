//! The words of the command line, put into the order that the parser takes: the command, its options, the rest. So an
//! option may stand before the command or after it.

use std::ffi::OsString;
use std::path::PathBuf;

use clap::parser::ValueSource;
use clap::{Arg, ArgMatches, Command};
use pump_bench::config::Config;

use crate::failure::Failure;
use crate::refusals::{beside_a_command, is_named};

/// Options that say the speed, one at most, by clap's ids.
const SPEEDS: [&str; 3] = ["rate", "speed", "within"];

/// The words in order.
pub(crate) struct Arranged {
    pub(crate) words: Vec<OsString>,
    /// The command and its subcommand, if there are any.
    pub(crate) path: Vec<String>,
    /// True if the short help is asked for.
    pub(crate) brief: bool,
}

/// An option as it was given, with its value.
struct Given {
    /// Clap's id of the option, or its name where no command has it.
    id: String,
    /// Number of commands before it.
    depth: usize,
    words: Vec<OsString>,
}

/// True if a program reads the report: the last `--format` among the words is `json`.
pub(crate) fn asks_for_json(words: &[OsString]) -> bool {
    let words = words.iter().map(|word| word.to_string_lossy()).take_while(|word| word != "--");
    let (mut json, mut is_value) = (false, false);
    for word in words {
        let value = if is_value { Some(&*word) } else { word.strip_prefix("--format=") };
        json = value.map_or(json, |value| value == "json");
        is_value = word == "--format";
    }
    json
}

/// Arranges the words of a command line. `root` is built: clap's own definitions say which options take a value.
pub(crate) fn arrange(words: impl Iterator<Item = OsString>, root: &Command) -> Result<Arranged, Failure> {
    let mut words = words.map(protect_minus).peekable();
    let program = words.next().unwrap_or_else(|| root.get_name().into());
    let (mut node, mut path) = (root, Vec::new());
    let (mut options, mut others): (Vec<Given>, Vec<OsString>) = (Vec::new(), Vec::new());
    let mut brief = false;
    while let Some(word) = words.next() {
        let text = word.to_string_lossy().into_owned();
        if text == "--" {
            others.push(word);
            others.extend(words.by_ref());
        } else if text.starts_with('-') && text.len() > 1 {
            brief |= text == "-h";
            let next = words.peek().map(|next| next.to_string_lossy().into_owned());
            let name = text.split('=').next().unwrap_or_default();
            let found = definitions(node, root, name);
            let takes_next = !text.contains('=') && takes_value(node, &found, next.as_deref());
            let mut given = Given {
                id: found.first().map_or(name.to_owned(), |arg| arg.get_id().to_string()),
                depth: path.len(),
                words: vec![word],
            };
            given.words.extend(takes_next.then(|| words.next()).flatten());
            // After the command an option counts in place of the one before it.
            options.retain(|before| before.id != given.id || before.depth == given.depth);
            options.push(given);
        } else if let Some(command) = node.find_subcommand(&text) {
            if !others.is_empty() && node.get_name() == root.get_name() {
                return Err(beside_a_command(&others, command, root));
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
    let options = options.into_iter().flat_map(|given| given.words);
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

/// The definitions of an option. Those of the command that was named so far count first; an option that stands before
/// its command may be any command's.
fn definitions<'a>(node: &'a Command, root: &'a Command, option: &str) -> Vec<&'a Arg> {
    let mut found = Vec::new();
    defined(node, option, &mut found);
    if found.is_empty() {
        defined(root, option, &mut found);
    }
    found
}

/// True if the word after an option with these definitions is its value.
fn takes_value(node: &Command, found: &[&Arg], next: Option<&str>) -> bool {
    // A value never begins with a hyphen: negative quantities are protected.
    if next.is_some_and(|next| next.starts_with('-') && next.len() > 1) {
        return false;
    }
    // A word that the option may have is its value, as in `--unfinished resume`.
    let is_choice = |arg: &&Arg| {
        next.is_some_and(|next| arg.get_possible_values().iter().any(|value| value.matches(next, false)))
    };
    if found.iter().any(is_choice) {
        return true;
    }
    let mut takes = found.iter().map(|arg| arg.get_action().takes_values());
    // One option is a flag of one command and has a value in another: before them it has none.
    let is_command = next.is_some_and(|next| node.find_subcommand(next).is_some());
    if is_command { !found.is_empty() && takes.all(|takes| takes) } else { takes.any(|takes| takes) }
}

/// Returns the matches of a command line with the configuration's defaults, if it is that of a dose. `command` gave
/// `typed`, the matches of the `words`. A typed option wins, and a typed speed or time is in place of a rate.
///
/// A configuration that cannot be used sets nothing: the dose itself refuses it.
///
/// # Errors
/// Clap's error where it refuses the words beside the defaults.
pub(crate) fn with_defaults(
    command: impl FnOnce() -> Command,
    words: &[OsString],
    typed: ArgMatches,
) -> Result<ArgMatches, clap::Error> {
    let has = |id: &str| typed.value_source(id).is_some_and(|source| source != ValueSource::DefaultValue);
    if typed.subcommand().is_some() || !has("volume") {
        return Ok(typed);
    }
    let Ok(config) = Config::of_user(typed.get_one::<PathBuf>("config").map(PathBuf::as_path)) else {
        return Ok(typed);
    };
    let is_typed = |key: &str| match SPEEDS.contains(&key) {
        true => SPEEDS.iter().any(|id| has(id)),
        false => has(key),
    };
    let defaults: Vec<_> = config.defaults().all().filter(|(key, _)| !is_typed(key)).collect();
    if defaults.is_empty() {
        return Ok(typed);
    }
    let set = |command: Command, (key, value): (&'static str, &str)| {
        command.mut_arg(key, |option| option.default_value(value.to_owned()))
    };
    defaults.into_iter().fold(command(), set).try_get_matches_from(words)
}

/// Finds every definition of an option in a command and its subcommands.
fn defined<'a>(command: &'a Command, option: &str, found: &mut Vec<&'a Arg>) {
    found.extend(command.get_arguments().filter(|arg| is_named(arg, option)));
    for subcommand in command.get_subcommands().filter(|subcommand| subcommand.get_name() != "help") {
        defined(subcommand, option, found);
    }
}
