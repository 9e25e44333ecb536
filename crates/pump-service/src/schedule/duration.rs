//! Lengths of time, as they are typed.

use serde::{Serialize, Serializer};

use super::error::ScheduleError;
use super::keys::Keys;

/// Units of a length of time, each with its seconds. A day is 24 hours, at a change of summer time too.
const UNITS: [(&str, f64); 4] = [("s", 1.0), ("min", 60.0), ("h", 3600.0), ("d", 86_400.0)];

/// A length of time in whole seconds, which keeps the words that it was typed with.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Duration {
    text: String,
    seconds: i64,
}

impl Duration {
    /// Returns the length in s, more than 0.
    pub fn seconds(&self) -> i64 {
        self.seconds
    }

    /// Returns the length as it was typed.
    pub fn as_str(&self) -> &str {
        &self.text
    }

    /// Reads the length at `key`, which is from `least` to `most`. Both are texts of lengths.
    pub(super) fn read(
        keys: &Keys<'_>,
        key: &str,
        least: &str,
        most: &str,
    ) -> Result<Option<Self>, ScheduleError> {
        let Some(text) = keys.text(key, "30min")? else { return Ok(None) };
        let range = seconds(least).unwrap_or(1)..=seconds(most).unwrap_or(i64::MAX);
        match seconds(&text).filter(|length| range.contains(length)) {
            Some(seconds) => Ok(Some(Self { text, seconds })),
            None => {
                let allowed = format!("{least} to {most} in whole seconds, with a unit of s, min, h, d");
                Err(keys.wrong(key, text, allowed, "write a number and its unit, as 30min"))
            }
        }
    }
}

impl Serialize for Duration {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&self.text)
    }
}

/// Returns the whole seconds of a typed length.
fn seconds(text: &str) -> Option<i64> {
    let unit_at = text.find(|c: char| c.is_ascii_alphabetic())?;
    let (number, unit) = text.split_at(unit_at);
    let number = number.trim_end();
    let is_plain = !number.is_empty() && number.chars().all(|c| c.is_ascii_digit() || c == '.');
    let (_, factor) = UNITS.iter().find(|(name, _)| *name == unit)?;
    let seconds = number.parse::<f64>().ok().filter(|_| is_plain)? * factor;
    // 0.1 min is 6 s, and the product of the floats need not be.
    let whole = seconds.round();
    ((seconds - whole).abs() < 1e-6 && whole < 1e12).then_some(whole as i64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_whole_seconds_with_a_unit() {
        for (text, length) in [
            ("30s", Some(30)),
            ("0.1min", Some(6)),
            ("1.5 h", Some(5400)),
            ("2d", Some(172_800)),
            ("0h", Some(0)),
            ("1.5s", None),
            ("30", None),
            ("min", None),
            ("-1h", None),
            ("1e3s", None),
            ("1h30min", None),
            ("99999999999999999d", None),
            ("1ms", None),
        ] {
            assert_eq!(seconds(text), length, "{text}");
        }
    }
}
