//! Inputs that must be alive while the service has its pumps: a leak sensor, a level, a watchdog.

use std::time::Duration;

use serde::de::Error;
use serde::{Deserialize, Deserializer};

use super::mqtt::{MqttTable, TOPICS, is_topic};
use crate::units::time_s;

/// Time between two runs of an input's command, where none is said.
const USUAL_EVERY: Duration = Duration::from_secs(5);

/// Time after which a silent input is taken for not well, where none is said.
const USUAL_SILENT: Duration = Duration::from_secs(30);

/// Times that an input may name, in s: a command that runs more often wears the computer, and a longer silence guards
/// nothing.
const TIMES_S: std::ops::RangeInclusive<f64> = 0.1..=86_400.0;

/// Table `[[service.input]]`: an input that must say that all is well, or its pumps stand.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct InputTable {
    /// Name of the input.
    pub name: String,
    /// Names of its pumps; all pumps of the service without it.
    pub pumps: Option<Vec<String>>,
    /// Command of the shell that says by its exit code 0 that all is well. Without one the input is told.
    pub command: Option<String>,
    /// Topic of the MQTT broker at which it is told. Without one it is told over HTTP.
    pub topic: Option<String>,
    /// Time from the end of the command to its next run.
    #[serde(default, deserialize_with = "time")]
    every: Option<Duration>,
    /// Time within which the input must say that all is well.
    #[serde(default, deserialize_with = "time")]
    silent: Option<Duration>,
}

impl InputTable {
    /// Returns the time from the end of the command to its next run.
    pub fn every(&self) -> Duration {
        self.every.unwrap_or(USUAL_EVERY)
    }

    /// Returns the time within which the input must say that all is well.
    pub fn silent(&self) -> Duration {
        self.silent.unwrap_or(USUAL_SILENT)
    }

    /// Returns the first value that is wrong by itself or beside others: key, value, and what is allowed. `pumps` are
    /// the names that the configuration has, `mqtt` is its broker, and `is_name` tells names.
    pub(super) fn wrong(
        &self,
        pumps: &[&str],
        mqtt: Option<&MqttTable>,
        is_name: fn(&str) -> bool,
    ) -> Option<[String; 3]> {
        let of = |key: &str, value: String, allowed: &str| {
            let key = format!("{key} of the [[service.input]] `{}`", self.name);
            Some([key, value, allowed.to_owned()])
        };
        if !is_name(&self.name) {
            let key = "the name of a [[service.input]]".to_owned();
            return Some([key, self.name.clone(), "1 to 64 of a-z, 0-9, - and _".to_owned()]);
        }
        if self.command.as_ref().is_some_and(|command| command.trim().is_empty()) {
            return of(
                "command",
                String::new(),
                "a command of the shell, or no key for an input that is told",
            );
        }
        if let Some((value, allowed)) = self.wrong_topic(mqtt) {
            return of("topic", value, &allowed);
        }
        if let Some(every) = self.every.filter(|_| self.command.is_none()) {
            return of(
                "every",
                format!("{every:?}"),
                "a `command` beside it; an input that is told has none",
            );
        }
        if self.command.is_some() && self.silent() <= self.every() {
            let allowed = format!("longer than `every`, which is {:?}", self.every());
            return of("silent", format!("{:?}", self.silent()), &allowed);
        }
        let named = self.pumps.as_deref()?;
        if named.is_empty() {
            return of("pumps", "[]".to_owned(), "one pump or more, or no key for all pumps");
        }
        let unknown = named.iter().find(|name| !pumps.contains(&name.as_str()))?;
        of("pumps", unknown.clone(), &format!("names of [pumps]: {}", pumps.join(", ")))
    }

    /// Returns a topic that is wrong, and what is allowed. The service's own topics carry commands and states.
    fn wrong_topic(&self, mqtt: Option<&MqttTable>) -> Option<(String, String)> {
        let topic = self.topic.clone()?;
        if self.command.is_some() {
            return Some((topic, "no `command` beside it: one of them speaks for the input".to_owned()));
        }
        if !is_topic(&topic) {
            return Some((topic, TOPICS.to_owned()));
        }
        let Some(root) = mqtt.map(|mqtt| mqtt.topic.as_str()) else {
            return Some((topic, "a table [service.mqtt] with the `broker` that has the topic".to_owned()));
        };
        let is_own = topic.strip_prefix(root).is_some_and(|rest| rest.is_empty() || rest.starts_with('/'));
        is_own.then(|| (topic, format!("a topic that is not below `{root}`, where the service's own are")))
    }
}

/// Reads a time with its unit.
fn time<'de, D: Deserializer<'de>>(from: D) -> Result<Option<Duration>, D::Error> {
    let text = String::deserialize(from)?;
    let time_s = time_s(&text).map_err(Error::custom)?;
    if TIMES_S.contains(&time_s) {
        return Ok(Some(Duration::from_secs_f64(time_s)));
    }
    Err(Error::custom(format!("the time is `{text}`; allowed: 0.1s to 24h")))
}
