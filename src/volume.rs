//! The volume on the command line, and what is typed in its place by mistake.

use std::ffi::OsString;

use clap::CommandFactory;
use pump_bench::units;
use pump_bench::units::Amount;

use crate::failure::Failure;
use crate::options::Cli;

/// A word that starts with `-` and a digit is a negative quantity and no option, wherever it stands. It passes the
/// parser with the minus sign U+2212 in place of the hyphen; quantities accept both.
pub(crate) fn protect_minus(word: OsString) -> OsString {
    match word.to_str() {
        Some(text) => match text.strip_prefix('-') {
            Some(rest) if rest.starts_with(|c: char| c.is_ascii_digit() || c == '.') => {
                format!("\u{2212}{rest}").into()
            }
            _ => word,
        },
        None => word,
    }
}

/// The one amount among the words.
pub(crate) fn only(words: &[String]) -> Result<Amount, Failure> {
    match words {
        [] => Err(Failure::refused("how much? Write a volume with its unit, as in `dose 25mL`")),
        [word] => one(word),
        [first, second, ..] => Err(several(first, second, words)),
    }
}

/// A volume before a command: never half obeyed.
pub(crate) fn beside_a_command(words: &[String]) -> Failure {
    Failure::refused(format!(
        "`{}` and a command together; give either a volume or a command",
        words.join(" ")
    ))
}

fn one(word: &str) -> Result<Amount, Failure> {
    units::amount(word).map_err(|error| if is_word(word) { unknown(word) } else { Failure::refused(error) })
}

fn several(first: &str, second: &str, words: &[String]) -> Failure {
    let joined = format!("{first}{second}").replace('\u{2212}', "-");
    if is_word(first) {
        unknown(first)
    } else if commands().iter().any(|command| command == second) {
        beside_a_command(words)
    } else if words.len() == 2 && units::amount(&joined).is_ok() {
        Failure::refused(format!("`{first} {second}` is two words; did you mean {joined}"))
    } else {
        Failure::refused(format!(
            "`{}`: one volume at a time, written as one word, as in 25mL",
            words.join(" ")
        ))
    }
}

/// Whether it looks like a command rather than a number.
fn is_word(word: &str) -> bool {
    let special = ["nan", "inf"].iter().any(|name| word.to_lowercase().starts_with(name));
    !special && word.starts_with(char::is_alphabetic)
}

fn unknown(word: &str) -> Failure {
    match nearest_command(word) {
        Some(command) => {
            Failure::refused(format!("unknown command `{word}`; did you mean `dose {command}`?"))
        }
        None => {
            let commands = commands().join(", ");
            Failure::refused(format!("`{word}` is neither a volume, as 25mL, nor a command: {commands}"))
        }
    }
}

fn commands() -> Vec<String> {
    Cli::command().get_subcommands().map(|command| command.get_name().to_owned()).collect()
}

/// The command that a mistyped word most likely means.
fn nearest_command(word: &str) -> Option<String> {
    let distance = |command: &String| strsim::damerau_levenshtein(word, command);
    commands().into_iter().filter(|command| distance(command) <= 2).min_by_key(distance)
}
