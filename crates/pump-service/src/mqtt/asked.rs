//! Payloads of commands.

use serde::Deserialize;
use serde::de::DeserializeOwned;

use super::topics::STOP;
use crate::order::{Options, Task, read_options};

/// Payload of a button of Home Assistant.
pub(super) const PRESS: &str = "PRESS";

/// Words of the commands.
const WORDS: &str = "dose, prime, resume, accept, clear, stop, volume";

/// Request of a message.
#[derive(Debug, PartialEq)]
pub(super) enum Asked {
    /// An order, with its key if it has one.
    Order { task: Task, options: Options, key: Option<String> },
    /// A dose of the volume that was kept.
    KeptDose,
    /// A volume to keep for that, in mL.
    Volume(f64),
    /// A stop.
    Stop,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct VolumeBody {
    volume: String,
    #[serde(default, deserialize_with = "read_options")]
    options: Options,
    key: Option<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct OptionsBody {
    #[serde(default, deserialize_with = "read_options")]
    options: Options,
    key: Option<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ReasonBody {
    reason: String,
    by: Option<String>,
    key: Option<String>,
}

impl Asked {
    /// Reads the payload of a command, or says what is wrong with it.
    pub(super) fn read(word: &str, payload: &[u8]) -> Result<Self, String> {
        if word == STOP {
            return Ok(Self::Stop);
        }
        let text = std::str::from_utf8(payload).map_err(|_| "the payload is no text in UTF-8".to_owned())?;
        let text = text.trim();
        let is_json = text.starts_with('{');
        let plain = |task| Ok(Self::Order { task, options: Options::new(), key: None });
        if text.is_empty() {
            // Deleting a retained message sends this.
            return Err(format!("the payload is empty, so nothing is done; {}", allowed(word)));
        }
        match word {
            "dose" | "prime" if is_json => {
                let VolumeBody { volume, options, key } = json(text)?;
                let task = if word == "dose" { Task::Dose { volume } } else { Task::Prime { volume } };
                Ok(Self::Order { task, options, key })
            }
            "dose" if text == PRESS => Ok(Self::KeptDose),
            "dose" => plain(Task::Dose { volume: text.to_owned() }),
            "prime" => plain(Task::Prime { volume: text.to_owned() }),
            "resume" if is_json => {
                let OptionsBody { options, key } = json(text)?;
                Ok(Self::Order { task: Task::Resume, options, key })
            }
            "accept" if is_json => {
                let OptionsBody { options, key } = json(text)?;
                Ok(Self::Order { task: Task::Accept, options, key })
            }
            "resume" if text == word || text == PRESS => plain(Task::Resume),
            "accept" if text == word || text == PRESS => plain(Task::Accept),
            "clear" if is_json => {
                let ReasonBody { reason, by, key } = json(text)?;
                Ok(Self::Order { task: Task::Clear { reason, by }, options: Options::new(), key })
            }
            "volume" => {
                let volume = text.parse().ok().filter(|ml: &f64| ml.is_finite() && *ml > 0.0);
                volume.map(Self::Volume).ok_or_else(|| wrong(word, text))
            }
            "resume" | "accept" | "clear" => Err(wrong(word, text)),
            _ => Err(format!("there is no command `{}`; allowed: {WORDS}", short(word))),
        }
    }

    /// Returns the key of an order.
    pub(super) fn key(&self) -> Option<&str> {
        match self {
            Self::Order { key, .. } => key.as_deref(),
            Self::KeptDose | Self::Volume(_) | Self::Stop => None,
        }
    }
}

fn allowed(word: &str) -> &'static str {
    match word {
        "dose" | "prime" => {
            "allowed: a volume as 25mL, or {\"volume\": \"25mL\", \"options\": {}, \"key\": \"...\"}"
        }
        "resume" => "allowed: resume, or {\"options\": {}, \"key\": \"...\"}",
        "accept" => "allowed: accept, or {\"options\": {}, \"key\": \"...\"}",
        "clear" => "allowed: {\"reason\": \"...\", \"by\": \"...\", \"key\": \"...\"}; `by` names the person",
        "volume" => "allowed: a number above 0, in mL",
        _ => "see docs/mqtt.md",
    }
}

fn wrong(word: &str, text: &str) -> String {
    format!("the payload is `{}`; {}", short(text), allowed(word))
}

/// Returns the begin of a text that somebody sent.
fn short(text: &str) -> String {
    text.chars().take(80).collect::<String>().escape_debug().to_string()
}

fn json<T: DeserializeOwned>(text: &str) -> Result<T, String> {
    serde_json::from_str(text).map_err(|error| format!("the payload: {error}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::order::Choice;

    #[test]
    fn a_dose_is_a_text_or_json() {
        let dose = |volume: &str, options, key| {
            Ok(Asked::Order { task: Task::Dose { volume: volume.to_owned() }, options, key })
        };
        assert_eq!(Asked::read("dose", b" 25mL\n"), dose("25mL", Options::new(), None));
        let options = Options::from([("smooth".to_owned(), Choice::Switch(true))]);
        let text = br#"{"volume": "2mL", "options": {"smooth": true}, "key": "a"}"#;
        assert_eq!(Asked::read("dose", text), dose("2mL", options, Some("a".to_owned())));
        assert_eq!(Asked::read("dose", b"PRESS"), Ok(Asked::KeptDose));
        assert!(Asked::read("prime", b"PRESS").is_ok(), "the command refuses it as a volume");
        let unknown = Asked::read("dose", br#"{"volume": "2mL", "rate": "1mL/s"}"#).unwrap_err();
        assert!(unknown.contains("unknown field `rate`"), "{unknown}");
    }

    #[test]
    fn an_empty_payload_moves_nothing_and_stops_all_the_same() {
        for word in ["dose", "prime", "resume", "accept", "clear", "volume"] {
            let refused = Asked::read(word, b" ").unwrap_err();
            assert!(refused.starts_with("the payload is empty, so nothing is done; allowed: "), "{refused}");
        }
        for payload in [&b""[..], b"PRESS", b"\xff"] {
            assert_eq!(Asked::read("stop", payload), Ok(Asked::Stop));
        }
    }

    #[test]
    fn a_word_that_was_not_meant_is_refused() {
        for (word, payload) in
            [("resume", "off"), ("accept", "no"), ("volume", "-1"), ("volume", "NaN"), ("x", "1")]
        {
            let refused = Asked::read(word, payload.as_bytes()).unwrap_err();
            assert!(refused.contains("allowed: "), "{refused}");
        }
        assert!(Asked::read("dose", b"\xff").is_err());
        assert_eq!(Asked::read("volume", b"12.5"), Ok(Asked::Volume(12.5)));
    }
}
