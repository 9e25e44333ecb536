//! The warnings of a rack's pumps: a line for each fact, with the pumps that it concerns.

use std::time::{Duration, Instant};

use crate::told_commands::{completed, meaning, shell_word};

/// Time for which warnings wait for like ones of other pumps. The motors of a step are given their steps 0.3 s ahead.
const PATIENCE: Duration = Duration::from_millis(50);

/// Pump of a rack: its name there, and its name or file as a user types it.
type Place<'a> = (&'a str, &'a str);

/// Warnings of some pumps, whose commands are not completed yet.
#[derive(Debug, Default)]
pub(super) struct Gathered {
    /// Text of each warning, with the names of the pumps that it concerns.
    facts: Vec<(String, Vec<String>)>,
    since: Option<Instant>,
}

impl Gathered {
    /// Adds a warning of a pump.
    pub(super) fn add(&mut self, pump: &str, text: String) {
        self.since.get_or_insert_with(Instant::now);
        match self.facts.iter_mut().find(|(known, _)| *known == text) {
            Some((_, pumps)) => pumps.push(pump.to_owned()),
            None => self.facts.push((text, vec![pump.to_owned()])),
        }
    }

    /// True once the warnings have waited for long enough.
    pub(super) fn is_due(&self) -> bool {
        self.since.is_some_and(|since| since.elapsed() > PATIENCE)
    }

    /// Takes the lines of the warnings. `places` are the pumps in the order of the rack.
    pub(super) fn take(&mut self, places: &[Place<'_>]) -> Vec<String> {
        self.since = None;
        self.facts.drain(..).map(|(text, pumps)| line(&text, &pumps, places)).collect()
    }
}

/// A line of a fact: the pumps, the text, and its commands as those of the first pump.
fn line(text: &str, pumps: &[String], places: &[Place<'_>]) -> String {
    let concerned: Vec<_> = places.iter().filter(|(name, _)| pumps.iter().any(|pump| pump == name)).collect();
    let names = concerned.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ");
    let Some(((first, place), others)) =
        concerned.split_first().map(|((name, place), rest)| ((name, place), rest))
    else {
        return text.to_owned();
    };
    let text = meaning(place, || completed(text).into_owned());
    if others.is_empty() || !text.contains("`dose ") {
        return format!("{names}: {text}");
    }
    let others = others.iter().map(|(_, place)| format!("`--pump {}`", shell_word(place)));
    let others = others.collect::<Vec<_>>().join(", ");
    format!("{names}: {text} (this is the command for {first}; for the others it has {others})")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fact_of_several_pumps_is_one_line_in_the_order_of_the_rack() {
        let places = [("acid", "acid"), ("base", "my base.toml"), ("salt", "salt")];
        let mut gathered = Gathered::default();
        for pump in ["salt", "acid", "base"] {
            gathered.add(pump, "nobody has weighed it; `dose calibrate run` does".to_owned());
        }
        gathered.add("base", "the tube is old".to_owned());
        gathered.add("salt", "the tube is old".to_owned());
        gathered.add("salt", "the line is long".to_owned());
        assert!(!gathered.is_due(), "warnings of other pumps may come");
        assert_eq!(
            gathered.take(&places),
            [
                "acid, base, salt: nobody has weighed it; `dose calibrate run` does (this is the command for acid; for \
                 the others it has `--pump 'my base.toml'`, `--pump salt`)",
                "base, salt: the tube is old",
                "salt: the line is long",
            ]
        );
        assert!(gathered.take(&places).is_empty());
    }
}
