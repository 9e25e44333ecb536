//! One input: what it said last, and whether it is well.

use std::time::{Duration, Instant};

use jiff::Timestamp;
use pump_bench::config::InputTable;
use serde::Serialize;
use utoipa::ToSchema;

/// Longest reason of an input that is kept, in letters.
const MOST_REASON: usize = 200;

/// Time from one telling of an input that goes on as before to its next.
const APART: Duration = Duration::from_secs(1);

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
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[non_exhaustive]
pub struct InputView {
    /// `input/1`.
    #[schema(value_type = String, example = "input/1")]
    pub schema: &'static str,
    /// Name of the input.
    pub name: String,
    /// Names of its pumps.
    pub pumps: Vec<String>,
    /// `waiting` for its first word, `well`, `bad` or `silent`.
    #[schema(value_type = String, example = "well")]
    pub state: &'static str,
    /// Last word of the input, `well` or `bad`; null before the first.
    #[schema(value_type = Option<String>, example = "well")]
    pub word: Option<&'static str>,
    /// Time since its last word, s; null before the first.
    pub age_s: Option<f64>,
    /// True if its last word is younger than `silent_s`.
    pub alive: bool,
    /// Reason why it is not well; null while it is.
    pub reason: Option<String>,
    /// Time of its last word; null before the first.
    #[schema(value_type = Option<String>, format = DateTime)]
    pub last: Option<Timestamp>,
    /// Topic of MQTT at which it is told; null if it is told over HTTP, or by its command.
    pub topic: Option<String>,
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
    /// Last word of the input, and its time.
    last: Option<(&'static str, Instant, Timestamp)>,
    /// Reason why its command said nothing.
    trouble: Option<String>,
    /// State and time of the last telling of it.
    told: (State, Instant),
}

impl Input {
    /// The input of a table, as of `now`. Without pumps of its own it guards all of `pumps`.
    pub(super) fn new(table: InputTable, pumps: &[String], now: Instant) -> Self {
        let pumps = table.pumps.clone().unwrap_or_else(|| pumps.to_vec());
        let told = (State::Waiting, now);
        Self { table, pumps, state: State::Waiting, alive: now, last: None, trouble: None, told }
    }

    pub(super) fn name(&self) -> &str {
        &self.table.name
    }

    /// Returns the command that speaks for it, and the time from its end to its next run.
    pub(super) fn command(&self) -> Option<(&str, Duration)> {
        Some((self.table.command.as_deref()?, self.table.every()))
    }

    /// Returns the topic at which it is told.
    pub(super) fn topic(&self) -> Option<&str> {
        self.table.topic.as_deref()
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
                self.last = Some(("well", now, time));
            }
            Word::Bad(reason) => {
                (self.state, self.last) = (State::Bad(reason), Some(("bad", now, time)));
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

    /// Returns true if watchers are to be told of it at `now`, and takes them for told: its state has changed, or it
    /// has spoken again and was not told of for a second.
    pub(super) fn is_news(&mut self, now: Instant) -> bool {
        let (state, told) = &self.told;
        let has_spoken = self.last.is_some_and(|(_, heard, _)| heard > *told);
        let is_due = has_spoken && now.saturating_duration_since(*told) >= APART;
        let is_news = *state != self.state || is_due;
        if is_news {
            self.told = (self.state.clone(), now);
        }
        is_news
    }

    /// Returns what is wrong by its last word, or by its silence. `None` while it is well.
    pub(super) fn fault(&self) -> Option<String> {
        match &self.state {
            State::Waiting | State::Well => None,
            State::Bad(reason) => Some(reason.clone()),
            State::Silent => {
                let trouble = self.trouble.as_ref().map_or(String::new(), |why| format!(" ({why})"));
                let silent = self.table.silent();
                Some(format!("silent, not once in {silent:?} it said that all is well{trouble}"))
            }
        }
    }

    /// Returns the reason why it is not well, with its name. `None` while it is.
    pub(super) fn reason(&self) -> Option<String> {
        Some(format!("{}: {}", self.table.name, self.fault()?))
    }

    /// Returns what people and programs are shown at `now`.
    pub(super) fn view(&self, now: Instant) -> InputView {
        let age = self.last.map(|(_, heard, _)| now.saturating_duration_since(heard));
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
            word: self.last.map(|(word, _, _)| word),
            age_s: age.map(|age| age.as_secs_f64()),
            alive: age.is_some_and(|age| age < self.table.silent()),
            reason: self.reason(),
            last: self.last.map(|(_, _, time)| time),
            topic: self.table.topic.clone(),
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
            input.view(at(begin, second)).state
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
    fn a_view_has_the_last_word_its_age_and_whether_it_lives() {
        let begin = Instant::now();
        let mut input = input(begin);
        let seen = |input: &Input, second| {
            let InputView { word, age_s, alive, .. } = input.view(at(begin, second));
            (word, age_s, alive)
        };
        assert_eq!(seen(&input, 3), (None, None, false));
        input.hear(Word::Well, at(begin, 10), Timestamp::UNIX_EPOCH);
        assert_eq!(seen(&input, 12), (Some("well"), Some(2.0), true));
        input.hear(Word::bad("water"), at(begin, 20), Timestamp::UNIX_EPOCH);
        assert_eq!(seen(&input, 49), (Some("bad"), Some(29.0), true));
        assert_eq!(seen(&input, 50), (Some("bad"), Some(30.0), false));
    }

    #[test]
    fn watchers_are_told_each_change_at_once_and_each_further_word_once_a_second() {
        let begin = Instant::now();
        let mut input = input(begin);
        let mut is_news = |word: Option<Word>, ms| {
            let now = begin + Duration::from_millis(ms);
            word.into_iter().for_each(|word| input.hear(word, now, Timestamp::UNIX_EPOCH));
            input.is_news(now)
        };
        assert_eq!([is_news(None, 0), is_news(Some(Word::Well), 100)], [false, true]);
        assert_eq!([is_news(Some(Word::Well), 200), is_news(Some(Word::Well), 1100)], [false, true]);
        assert_eq!([is_news(None, 5000), is_news(Some(Word::bad("water")), 5001)], [false, true]);
        assert_eq!([is_news(Some(Word::bad("oil")), 5002), is_news(None, 9000)], [true, false]);
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
