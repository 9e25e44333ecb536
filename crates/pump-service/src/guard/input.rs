//! One input: what it said last, and whether it is well.

use std::time::{Duration, Instant};

use jiff::Timestamp;
use pump_bench::config::InputTable;
use serde::Serialize;

/// Longest reason of an input that is kept, in letters.
const MOST_REASON: usize = 200;

/// Word of an input.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Word {
    /// All is well.
    Well,
    /// Something is wrong, for this reason.
    Bad(String),
    /// The command of the input said nothing, for this reason.
    Nothing(String),
}

impl Word {
    /// The word of an input that is not well. No text of a reason makes it unheard: it is cut, and control characters
    /// are left out.
    pub(super) fn bad(reason: &str) -> Self {
        let plain: String = reason.chars().filter(|c| !c.is_control()).take(MOST_REASON).collect();
        let reason = plain.trim();
        Self::Bad(if reason.is_empty() { "it says that not all is well" } else { reason }.to_owned())
    }
}

/// State of an input.
#[derive(Debug, Clone, PartialEq, Eq)]
enum State {
    /// It has said nothing since the service began.
    Waiting,
    Well,
    Bad(String),
    Silent,
}

/// Input as people and programs are shown it, `input/1`.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct InputView {
    /// `input/1`.
    pub schema: &'static str,
    /// Name of the input.
    pub name: String,
    /// Names of its pumps.
    pub pumps: Vec<String>,
    /// `waiting` for its first word, `well`, `bad` or `silent`.
    pub state: &'static str,
    /// Reason why it is not well; null while it is.
    pub reason: Option<String>,
    /// Time of its last word; null before the first.
    pub last: Option<Timestamp>,
    /// True if it is told over HTTP or MQTT, false if its command speaks for it.
    pub told: bool,
    /// Time within which it must say that all is well, s.
    pub silent_s: f64,
}

/// Input that must be alive.
#[derive(Debug)]
pub(super) struct Input {
    table: InputTable,
    pumps: Vec<String>,
    state: State,
    /// Time at which it last said that all is well, or at which the service began.
    alive: Instant,
    last: Option<Timestamp>,
    /// Reason why its command said nothing.
    trouble: Option<String>,
}

impl Input {
    /// The input of a table, as of `now`. Without pumps of its own it guards all of `pumps`.
    pub(super) fn new(table: InputTable, pumps: &[String], now: Instant) -> Self {
        let pumps = table.pumps.clone().unwrap_or_else(|| pumps.to_vec());
        Self { table, pumps, state: State::Waiting, alive: now, last: None, trouble: None }
    }

    pub(super) fn name(&self) -> &str {
        &self.table.name
    }

    /// Returns the command that speaks for it, and the time from its end to its next run.
    pub(super) fn command(&self) -> Option<(&str, Duration)> {
        Some((self.table.command.as_deref()?, self.table.every()))
    }

    /// Returns true if it guards the pump of this name.
    pub(super) fn guards(&self, pump: &str) -> bool {
        self.pumps.iter().any(|guarded| guarded == pump)
    }

    /// Takes its word at `now`.
    pub(super) fn hear(&mut self, word: Word, now: Instant, time: Timestamp) {
        match word {
            Word::Well => {
                (self.state, self.alive, self.trouble) = (State::Well, now, None);
                self.last = Some(time);
            }
            Word::Bad(reason) => {
                (self.state, self.last) = (State::Bad(reason), Some(time));
            }
            Word::Nothing(why) => self.trouble = Some(why),
        }
    }

    /// Takes it for silent if it has not said for too long that all is well.
    pub(super) fn look(&mut self, now: Instant) {
        let is_silent = now.saturating_duration_since(self.alive) >= self.table.silent();
        if is_silent && matches!(self.state, State::Waiting | State::Well) {
            self.state = State::Silent;
        }
    }

    /// Returns the reason why it is not well. `None` while it is.
    pub(super) fn reason(&self) -> Option<String> {
        let name = &self.table.name;
        match &self.state {
            State::Waiting | State::Well => None,
            State::Bad(reason) => Some(format!("{name}: {reason}")),
            State::Silent => {
                let trouble = self.trouble.as_ref().map_or(String::new(), |why| format!(" ({why})"));
                let silent = self.table.silent();
                Some(format!("{name}: silent, not once in {silent:?} it said that all is well{trouble}"))
            }
        }
    }

    /// Returns what people and programs are shown.
    pub(super) fn view(&self) -> InputView {
        let state = match self.state {
            State::Waiting => "waiting",
            State::Well => "well",
            State::Bad(_) => "bad",
            State::Silent => "silent",
        };
        InputView {
            schema: "input/1",
            name: self.table.name.clone(),
            pumps: self.pumps.clone(),
            state,
            reason: self.reason(),
            last: self.last,
            told: self.table.command.is_none(),
            silent_s: self.table.silent().as_secs_f64(),
        }
    }
}

#[cfg(test)]
mod tests {
    use pump_bench::config::Config;

    use super::*;

    /// An input that is silent after 30 s, at its begin.
    fn input(begin: Instant) -> Input {
        let text = "schema = \"config/1\"\n[[service.input]]\nname = \"leak\"\nsilent = \"30s\"\n";
        let config = Config::parse(text, "config.toml".as_ref()).unwrap();
        Input::new(config.service().inputs[0].clone(), &["acid".to_owned()], begin)
    }

    fn at(begin: Instant, seconds: u64) -> Instant {
        begin + Duration::from_secs(seconds)
    }

    #[test]
    fn an_input_is_silent_once_its_time_has_passed_and_not_before() {
        let begin = Instant::now();
        let mut input = input(begin);
        let mut state = |word: Option<Word>, second| {
            word.into_iter().for_each(|word| input.hear(word, at(begin, second), Timestamp::UNIX_EPOCH));
            input.look(at(begin, second));
            input.view().state
        };
        assert_eq!([state(None, 0), state(None, 29), state(None, 30)], ["waiting", "waiting", "silent"]);
        assert_eq!(
            [state(Some(Word::Well), 40), state(None, 69), state(None, 70)],
            ["well", "well", "silent"]
        );
        // A word of a command that says nothing is no sign of life, and neither is one that all is not well.
        assert_eq!(state(Some(Word::Nothing("no shell".to_owned())), 71), "silent");
        assert_eq!(state(Some(Word::bad("water")), 72), "bad");
        assert_eq!([state(None, 200), state(Some(Word::Well), 201)], ["bad", "well"]);
    }

    #[test]
    fn the_reason_of_a_silent_input_says_what_its_command_met() {
        let begin = Instant::now();
        let mut input = input(begin);
        input.hear(
            Word::Nothing("its command took longer than 10s".to_owned()),
            begin,
            Timestamp::UNIX_EPOCH,
        );
        assert_eq!(input.reason(), None);
        input.look(at(begin, 30));
        let reason =
            "leak: silent, not once in 30s it said that all is well (its command took longer than 10s)";
        assert_eq!(input.reason().as_deref(), Some(reason));
    }

    #[test]
    fn no_reason_makes_a_bad_word_unheard() {
        let long = "x".repeat(5000);
        for (reason, kept) in [
            ("water", "water"),
            ("", "it says that not all is well"),
            ("\n\t", "it says that not all is well"),
            ("a\u{1b}[2Jb", "a[2Jb"),
            (&long, &long[..MOST_REASON]),
        ] {
            assert_eq!(Word::bad(reason), Word::Bad(kept.to_owned()));
        }
    }
}
