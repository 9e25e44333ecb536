//! Words to choose from, read by the library's own `FromStr`.

use std::fmt::Display;
use std::str::FromStr;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

/// Reads one of these choices; help, completions and messages list their words, each with its meaning.
pub(crate) fn choice<T>(choices: &[(T, &'static str)]) -> impl TypedValueParser<Value = T>
where
    T: FromStr<Err: Display> + Display + Clone + Send + Sync + 'static,
{
    let words = choices.iter().map(|(choice, help)| PossibleValue::new(choice.to_string()).help(*help));
    PossibleValuesParser::new(words).try_map(|word| word.parse::<T>().map_err(|error| error.to_string()))
}
