//! Words to choose from, read by the library's own `FromStr`.

use std::fmt::Display;
use std::str::FromStr;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

/// Reads one of these choices; help, completions and messages list their words, each with its meaning.
pub(crate) fn choice<T>(choices: &[(T, &'static str)]) -> impl TypedValueParser<Value = T>
where
    T: FromStr<Err: Display> + Display + PartialEq + Clone + Send + Sync + 'static,
{
    choice_or(choices, &[])
}

/// Reads one of these choices, as [`choice`] does, or by a word of earlier versions, which nothing lists.
pub(crate) fn choice_or<T>(
    choices: &[(T, &'static str)],
    earlier: &[(T, &'static str)],
) -> impl TypedValueParser<Value = T>
where
    T: FromStr<Err: Display> + Display + PartialEq + Clone + Send + Sync + 'static,
{
    let words = choices.iter().map(|(choice, help)| {
        let aliases = earlier.iter().filter(|(other, _)| other == choice).map(|(_, word)| *word);
        PossibleValue::new(choice.to_string()).help(*help).aliases(aliases)
    });
    PossibleValuesParser::new(words).try_map(|word| word.parse::<T>().map_err(|error| error.to_string()))
}
