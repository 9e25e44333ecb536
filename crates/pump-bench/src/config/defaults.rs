//! Options that a configuration sets for every dose whose command does not type them.

use std::fmt::Display;
use std::str::FromStr;

use pump_ctl::plan::{Finish, Ramps};
use serde::{Deserialize, Serialize};

use crate::safety::UnfinishedPolicy;
use crate::units;

/// Options of `dose <VOLUME>` that a configuration sets, each as it would be typed. `None` leaves what is built in.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct DoseDefaults {
    /// Mean flow, as `10mL/s`, or `max`.
    pub rate: Option<String>,
    /// Ramps, `line` or `fastest`.
    pub ramps: Option<String>,
    /// Place in a pitch at which a dose may end, `any` or `low-flow`.
    pub finish: Option<String>,
    /// Most volume in any 24 hours, as `50mL`.
    pub max_per_day: Option<String>,
    /// Policy for an interrupted dose on record, `ask`, `resume` or `accept`.
    pub unfinished: Option<String>,
}

impl DoseDefaults {
    /// Returns each option that is set, by its key, with its value.
    pub fn all(&self) -> impl Iterator<Item = (&'static str, &str)> {
        let Self { rate, ramps, finish, max_per_day, unfinished } = self;
        [
            ("rate", rate),
            ("ramps", ramps),
            ("finish", finish),
            ("max_per_day", max_per_day),
            ("unfinished", unfinished),
        ]
        .into_iter()
        .filter_map(|(key, value)| Some((key, value.as_deref()?)))
    }

    /// Returns the first value that its option does not take: key, value, and the reason.
    pub(super) fn wrong(&self) -> Option<(&'static str, &str, String)> {
        let reason = |key, value: &str| match key {
            "rate" => reason(units::rate(value)),
            "ramps" => reason_of_word::<Ramps>(value),
            "finish" => reason_of_word::<Finish>(value),
            "max_per_day" => reason(units::volume_ml(value)),
            _ => reason_of_word::<UnfinishedPolicy>(value),
        };
        self.all().find_map(|(key, value)| Some((key, value, reason(key, value)?)))
    }
}

fn reason<T>(read: Result<T, impl Display>) -> Option<String> {
    read.err().map(|error| error.to_string())
}

fn reason_of_word<T: FromStr<Err: Display>>(value: &str) -> Option<String> {
    reason(value.parse::<T>())
}
