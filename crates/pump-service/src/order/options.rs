//! Options of an order: those of the command that reach no file, no device and no other program.

use std::collections::BTreeMap;

use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize};
use serde_json::Value;

use super::error::OrderError;
use super::task::{Task, text};

/// Options by their names without dashes.
pub type Options = BTreeMap<String, Choice>;

/// Value of an option.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(untagged)]
pub enum Choice {
    /// An option with a value, as it was typed.
    Text(String),
    /// An option without a value: `true`, or `false` for one that is left out.
    Switch(bool),
}

/// Reads options. A value of another type is refused by the name of its option.
///
/// # Errors
///
/// The deserializer's error, and that of such a value.
pub(crate) fn read_options<'de, D: Deserializer<'de>>(from: D) -> Result<Options, D::Error> {
    let values = BTreeMap::<String, Value>::deserialize(from)?;
    let read = |(name, value): (String, Value)| match value {
        Value::String(text) => Ok((name, Choice::Text(text))),
        Value::Bool(on) => Ok((name, Choice::Switch(on))),
        // The log and the view of a pump have the number of a dose as a number.
        Value::Number(number) if name == "dose" => Ok((name, Choice::Text(number.to_string()))),
        other => {
            let instead = match name.as_str() {
                "rate" => "write a text with its unit, as \"5mL/min\"",
                "repeat" => "write a text, as \"5\"",
                _ => "write a text with its unit, or true for an option without a value",
            };
            Err(D::Error::custom(format!("the option {name} is `{other}`; {instead}")))
        }
    };
    values.into_iter().map(read).collect()
}

/// Options of motions that have a value.
const OF_MOTIONS: [&str; 7] =
    ["rate", "speed", "within", "ramps", "max-outlet-pressure", "min-inlet-pressure", "start-angle"];

/// Options with a value that doses, primes, purges and runs have beside those of motions.
const OF_VOLUMES: [&str; 5] = ["fluid", "temperature", "tube-limit", "max-per-day", "unfinished"];

/// Returns the word of an option with its value.
pub(crate) fn option(name: &str, value: &str) -> String {
    format!("--{name}={value}")
}

/// Returns the word of an option without a value.
pub(crate) fn switch(name: &str) -> String {
    format!("--{name}")
}

impl Task {
    /// Options with a value.
    fn valued(&self) -> Vec<&'static str> {
        let of = |own: &[&'static str]| [&OF_MOTIONS[..], &OF_VOLUMES[..], own].concat();
        match self {
            Self::Dose { .. } => of(&["retract", "finish", "repeat", "every", "missed"]),
            Self::Prime { .. } | Self::Purge { .. } => of(&[]),
            Self::Run => of(&["for", "volume"]),
            Self::Resume => {
                let not = |name: &&str| *name != "start-angle";
                OF_MOTIONS.into_iter().filter(not).chain(["fluid", "temperature", "finish", "dose"]).collect()
            }
            Self::Rack { .. } => vec!["unfinished", "max-per-day"],
            Self::Calibrate { .. } => vec!["dose", "scale"],
            Self::Accept => vec!["dose"],
            Self::Stand { .. }
            | Self::Clear { .. }
            | Self::Emptied
            | Self::UseCalibration { .. }
            | Self::Command { .. } => Vec::new(),
        }
    }

    /// Options without a value.
    fn switches(&self) -> &'static [&'static str] {
        match self {
            Self::Dose { .. } | Self::Prime { .. } | Self::Purge { .. } | Self::Run => {
                &["smooth", "reverse", "dry-run"]
            }
            Self::Resume => &["smooth", "dry-run"],
            Self::Rack { .. } => &["dry-run"],
            Self::Calibrate { .. } => &["anew", "anyway", "dry-run"],
            Self::Accept => &["anyway"],
            Self::Stand { .. }
            | Self::Clear { .. }
            | Self::Emptied
            | Self::UseCalibration { .. }
            | Self::Command { .. } => &[],
        }
    }

    /// Returns the options as words of the command line.
    pub(super) fn options(&self, options: &Options) -> Result<Vec<String>, OrderError> {
        let (valued, switches) = (self.valued(), self.switches());
        let mut words = Vec::new();
        for (name, choice) in options {
            let is_valued = valued.contains(&name.as_str());
            let is_switch = switches.contains(&name.as_str());
            match choice {
                _ if !is_valued && !is_switch => {
                    let allowed = valued.iter().chain(switches).copied().collect::<Vec<_>>().join(", ");
                    let allowed = if allowed.is_empty() { "none".to_owned() } else { allowed };
                    return Err(OrderError::Option { option: name.clone(), allowed });
                }
                Choice::Text(value) if is_valued => {
                    words.push(option(name, text("an option", value)?));
                }
                Choice::Switch(on) if is_switch => {
                    words.extend(on.then(|| switch(name)));
                }
                Choice::Text(_) => {
                    let (wrong, instead) = ("takes no value", "write true or false");
                    return Err(OrderError::Value { option: name.clone(), wrong, instead });
                }
                Choice::Switch(_) => {
                    let (wrong, instead) = ("needs a value", "write it as a text with its unit");
                    return Err(OrderError::Value { option: name.clone(), wrong, instead });
                }
            }
        }
        Ok(words)
    }
}
