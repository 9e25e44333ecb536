//! The thing that an order asks for.

use serde::{Deserialize, Serialize};

use super::error::OrderError;
use super::options::option;

/// Thing that an order asks for. Texts are as they were typed; the command checks them.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(tag = "task", rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Task {
    /// A dose, or several with `repeat`.
    Dose {
        /// Volume or mass with its unit; negative in reverse.
        volume: String,
    },
    /// The line is filled.
    Prime {
        /// Volume with its unit; negative in reverse.
        volume: String,
    },
    /// The line is emptied.
    Purge {
        /// Volume with its unit; negative in reverse.
        volume: String,
    },
    /// A flow for a time, for a volume, or until it is stopped.
    Run,
    /// The rest of an interrupted dose.
    Resume,
    /// An interrupted dose is accepted as it is.
    Accept,
    /// The pump stands until a person clears it.
    Stand {
        /// Reason, which every refusal shows.
        reason: String,
    },
    /// The pump that stands may go on.
    Clear {
        /// Reason of the person who clears it.
        reason: String,
        /// Name of that person. Orders of earlier versions had none.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        by: Option<String>,
    },
    /// The receiving vessel was emptied.
    Emptied,
    /// The last dose was weighed or measured.
    Calibrate {
        /// Mass or volume with its unit.
        reading: String,
    },
    /// Doses use another calibration from now on, or none.
    UseCalibration {
        /// Number of the calibration, or `none`.
        calibration: String,
    },
    /// Several pumps by one timetable.
    Rack {
        /// Name of the rack in the configuration.
        rack: String,
    },
    /// A command that this machine's user typed. Nobody else gives such an order.
    Command {
        /// Words after the program's name.
        words: Vec<String>,
    },
}

/// Most bytes of a text.
const MOST_BYTES: usize = 1000;

impl Task {
    /// Returns the word that names the task.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Dose { .. } => "dose",
            Self::Prime { .. } => "prime",
            Self::Purge { .. } => "purge",
            Self::Run => "run",
            Self::Resume => "resume",
            Self::Accept => "accept",
            Self::Stand { .. } => "stand",
            Self::Clear { .. } => "clear",
            Self::Emptied => "emptied",
            Self::Calibrate { .. } => "calibrate",
            Self::UseCalibration { .. } => "use-calibration",
            Self::Rack { .. } => "rack",
            Self::Command { .. } => "command",
        }
    }

    /// Returns what a pump is doing that carries the task out, as `dosing 25mL`.
    pub(crate) fn doing(&self) -> String {
        match self {
            Self::Dose { volume } => format!("dosing {volume}"),
            Self::Prime { volume } => format!("priming {volume}"),
            Self::Purge { volume } => format!("purging {volume}"),
            Self::Run => "running".to_owned(),
            Self::Resume => "delivering the rest of a dose".to_owned(),
            Self::Accept => "having its dose accepted".to_owned(),
            Self::Stand { .. } => "being put to stand".to_owned(),
            Self::Clear { .. } => "being cleared".to_owned(),
            Self::Emptied => "having its vessel emptied on record".to_owned(),
            Self::Calibrate { .. } | Self::UseCalibration { .. } => "being calibrated".to_owned(),
            Self::Rack { rack } => format!("running in rack {rack}"),
            Self::Command { words } => doing_typed(words),
        }
    }

    /// Returns true if the task turns a motor.
    pub fn moves(&self) -> bool {
        match self {
            Self::Accept
            | Self::Stand { .. }
            | Self::Clear { .. }
            | Self::Emptied
            | Self::Calibrate { .. }
            | Self::UseCalibration { .. } => false,
            Self::Command { words } => {
                words.first().is_none_or(|word| !["accept", "safety", "vessel"].contains(&word.as_str()))
            }
            Self::Dose { .. }
            | Self::Prime { .. }
            | Self::Purge { .. }
            | Self::Run
            | Self::Resume
            | Self::Rack { .. } => true,
        }
    }

    /// Returns true if the task puts a pump to stand.
    pub(crate) fn stands(&self) -> bool {
        matches!(self, Self::Stand { .. }) || self.is_typed(&["safety", "stand"])
    }

    /// Returns true if the task lets a pump go on that stands.
    pub(crate) fn clears(&self) -> bool {
        matches!(self, Self::Clear { .. }) || self.is_typed(&["safety", "clear"])
    }

    /// Returns the reason of a clearing, and the name of the person. `None` for another task.
    pub(crate) fn clearing(&self) -> Option<(&str, &str)> {
        match self {
            Self::Clear { reason, by } => Some((reason, by.as_deref()?)),
            Self::Command { words } if self.clears() => {
                let of = |name: &str| words.iter().find_map(|word| word.strip_prefix(&option(name, "")));
                Some((of("reason")?, of("by")?))
            }
            _ => None,
        }
    }

    /// Returns true if the task accepts an interrupted dose.
    pub(crate) fn accepts(&self) -> bool {
        matches!(self, Self::Accept) || self.is_typed(&["accept"])
    }

    /// Returns true for a typed command that begins with these words.
    fn is_typed(&self, begin: &[&str]) -> bool {
        let Self::Command { words } = self else { return false };
        words.iter().map(String::as_str).take(begin.len()).eq(begin.iter().copied())
    }

    /// Returns the words of the command before its options, for `pump`.
    pub(super) fn words(&self, pump: &str) -> Result<Vec<String>, OrderError> {
        let words = |words: &[&str]| words.iter().map(|word| (*word).to_owned()).collect::<Vec<String>>();
        Ok(match self {
            Self::Dose { volume } => words(&[amount("volume", volume)?]),
            Self::Prime { volume } => words(&["prime", amount("volume", volume)?]),
            Self::Purge { volume } => words(&["purge", amount("volume", volume)?]),
            Self::Run => words(&["run"]),
            Self::Resume => words(&["resume"]),
            Self::Accept => words(&["accept"]),
            Self::Stand { reason } => {
                let reason = text("reason", reason)?;
                words(&["safety", "stand", name("pump", pump)?, &option("reason", reason)])
            }
            Self::Clear { reason, by } => {
                let reason = text("reason", reason)?;
                let by = by.as_deref().unwrap_or_default();
                if by.trim().is_empty() {
                    return Err(wrong("by", by, "write the name of the person who clears the pump"));
                }
                let (pump, by) = (name("pump", pump)?, text("by", by)?);
                words(&["safety", "clear", pump, &option("reason", reason), &option("by", by)])
            }
            Self::Emptied => words(&["vessel", "emptied"]),
            Self::Calibrate { reading } => words(&["calibrate", "last", amount("reading", reading)?]),
            Self::UseCalibration { calibration } => {
                let is_number = !calibration.is_empty() && calibration.bytes().all(|c| c.is_ascii_digit());
                if calibration != "none" && !is_number {
                    return Err(wrong("calibration", calibration, "write its number, or none"));
                }
                words(&["calibrate", "use", calibration])
            }
            Self::Rack { rack } => words(&["run", name("rack", rack)?]),
            Self::Command { words } => words.clone(),
        })
    }
}

/// Returns what a pump is doing by the words of a command.
fn doing_typed(words: &[String]) -> String {
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    match words[..] {
        ["prime", volume, ..] if amount("volume", volume).is_ok() => format!("priming {volume}"),
        ["purge", volume, ..] if amount("volume", volume).is_ok() => format!("purging {volume}"),
        ["run", ..] => "running".to_owned(),
        ["resume", ..] => "delivering the rest of a dose".to_owned(),
        [volume, ..] if amount("volume", volume).is_ok() => format!("dosing {volume}"),
        _ => format!("carrying out the command `{}`", words.join(" ")),
    }
}

/// Passes a number with its unit. A word with two dashes would be an option.
fn amount<'a>(what: &'static str, value: &'a str) -> Result<&'a str, OrderError> {
    let value = text(what, value)?.trim();
    let first = value.trim_start_matches(['-', '+', '−']).chars().next();
    if first.is_some_and(|c| c.is_ascii_digit() || c == '.') && !value.starts_with("--") {
        return Ok(value);
    }
    let is_reading = what == "reading";
    let allowed = if is_reading {
        "write a number with its unit, as 25.3g"
    } else {
        "write a number with its unit, as 25mL"
    };
    Err(wrong(what, value, allowed))
}

/// Passes the name of a pump or a rack of the configuration. A path would be any file of the computer.
pub(crate) fn name<'a>(what: &'static str, value: &'a str) -> Result<&'a str, OrderError> {
    let letters = |c: char| c.is_alphanumeric() || c == '-' || c == '_' || c == '.';
    if value.chars().all(letters)
        && !value.starts_with(['-', '.'])
        && !value.is_empty()
        && !value.ends_with(".toml")
    {
        return Ok(value);
    }
    Err(wrong(what, value, "write a name of the configuration"))
}

/// Passes a text without control characters.
pub(crate) fn text<'a>(what: &'static str, value: &'a str) -> Result<&'a str, OrderError> {
    if value.trim().is_empty() {
        return Err(wrong(what, value, "write it"));
    }
    if value.len() > MOST_BYTES {
        return Err(wrong(what, "too long", "1000 bytes are allowed"));
    }
    if value.chars().any(char::is_control) {
        return Err(wrong(what, value, "leave control characters out"));
    }
    Ok(value)
}

fn wrong(what: &'static str, value: &str, allowed: &'static str) -> OrderError {
    OrderError::Text { what, value: value.escape_debug().to_string(), allowed }
}
