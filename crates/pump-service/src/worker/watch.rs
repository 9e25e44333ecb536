//! A watch over a process: it tells its progress while a motor turns, and answers a stop.

use std::collections::BTreeSet;
use std::time::Duration;

use serde_json::Value;
use tokio::time::Instant;

use super::line::Line;

/// Silence of a process whose motor turns that people are told of. A motor's board that falls silent is sought for 3 s.
pub(crate) const SILENT_AFTER: Duration = Duration::from_secs(5);

/// Silence after a stop, and then after SIGTERM, that has the process ended.
pub(crate) const ANSWERS_WITHIN: Duration = Duration::from_secs(2);

/// Longest time from a stop to the end of the process, if it speaks: it decelerates, records, and tells a person.
const ENDS_WITHIN: Duration = Duration::from_secs(30);

/// Longest time from a kill to the end of the process.
const DIES_WITHIN: Duration = Duration::from_secs(5);

/// Time between two looks.
pub(super) const LOOK: Duration = Duration::from_millis(250);

/// Pause between two looks after which the service itself was held up, so that silence tells nothing.
const HELD_UP: Duration = Duration::from_secs(1);

/// Thing that a process does or leaves undone, beside its lines.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Sign {
    /// The motor turns, and the process has told nothing for this time.
    Silent(Duration),
    /// It speaks again.
    Speaks,
    /// It has not answered a stop: it is asked to end by SIGTERM.
    Unanswered,
    /// It has not answered SIGTERM either: it is killed.
    Killed,
    /// It speaks, but has not ended for long after the stop; or it was killed, and has not ended.
    GoesOn,
}

/// How far the end of a process has been brought that does not answer.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Step {
    None,
    Asked(Instant),
    Killed(Instant),
}

/// Watch over one process.
#[derive(Debug)]
pub(super) struct Watch {
    looked: Instant,
    heard: Instant,
    /// Pumps whose motors turn, by their ids.
    moving: BTreeSet<String>,
    is_silent: bool,
    /// Time of the first stop.
    stopped: Option<Instant>,
    /// True once a report or a failure came after the stop.
    is_answered: bool,
    step: Step,
    has_told_that_it_goes_on: bool,
}

impl Watch {
    pub(super) fn new(now: Instant) -> Self {
        Self {
            looked: now,
            heard: now,
            moving: BTreeSet::new(),
            is_silent: false,
            stopped: None,
            is_answered: false,
            step: Step::None,
            has_told_that_it_goes_on: false,
        }
    }

    /// Notes that the process was asked to stop.
    pub(super) fn stop(&mut self, now: Instant) {
        self.stopped.get_or_insert(now);
    }

    /// Returns true if the process was ended, or asked to end by a signal, because it did not answer.
    pub(super) fn has_ended_it(&self) -> bool {
        self.step != Step::None
    }

    /// Hears a line of the process.
    pub(super) fn hear(&mut self, line: &Line, now: Instant) -> Option<Sign> {
        self.heard = now;
        match line {
            Line::Progress(value) => {
                let id = value.get("pump").and_then(Value::as_str).unwrap_or_default();
                let of = |key: &str| value.get(key).and_then(Value::as_u64);
                let is_at_end = of("of_steps").is_some_and(|all| all > 0 && of("steps") == Some(all));
                if value.get("state").and_then(Value::as_str) == Some("moving") && !is_at_end {
                    self.moving.insert(id.to_owned());
                } else {
                    self.moving.remove(id);
                }
            }
            Line::Message(_) => {}
            Line::Report(_) | Line::Words(_) | Line::Error(_) | Line::Failed(_) | Line::Ending => {
                self.moving.clear();
                self.is_answered |= self.stopped.is_some();
            }
        }
        std::mem::take(&mut self.is_silent).then_some(Sign::Speaks)
    }

    /// Looks at the clock.
    pub(super) fn look(&mut self, now: Instant) -> Option<Sign> {
        let is_held_up = now.duration_since(std::mem::replace(&mut self.looked, now)) > HELD_UP;
        if is_held_up {
            self.heard = now;
        }
        let quiet = now.duration_since(self.heard);
        if !self.is_silent && !self.moving.is_empty() && quiet >= SILENT_AFTER {
            self.is_silent = true;
            return Some(Sign::Silent(quiet));
        }
        let stopped = self.stopped?;
        let since = stopped.max(self.heard);
        let answers_within = if self.is_answered { ENDS_WITHIN } else { ANSWERS_WITHIN };
        match self.step {
            Step::None if now.duration_since(since) >= answers_within => {
                self.step = Step::Asked(now);
                Some(Sign::Unanswered)
            }
            // It spoke again, so it may still stop by itself.
            Step::Asked(at) if self.heard > at => {
                self.step = Step::None;
                None
            }
            Step::Asked(at) if now.duration_since(at) >= ANSWERS_WITHIN => {
                self.step = Step::Killed(now);
                Some(Sign::Killed)
            }
            Step::Killed(at) if now.duration_since(at) < DIES_WITHIN => None,
            Step::None if now.duration_since(stopped) < ENDS_WITHIN => None,
            Step::Asked(_) => None,
            Step::None | Step::Killed(_) => {
                (!std::mem::replace(&mut self.has_told_that_it_goes_on, true)).then_some(Sign::GoesOn)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    /// Signs of a watch that is looked at for `seconds`, with the time of each in quarters of a second.
    fn signs(watch: &mut Watch, begun: Instant, from: u32, to: u32) -> Vec<(u32, Sign)> {
        (from..to).filter_map(|look| Some((look, watch.look(begun + look * LOOK)?))).collect()
    }

    fn moving(steps: u64, of_steps: u64) -> Line {
        Line::Progress(json!({"pump": "a", "state": "moving", "steps": steps, "of_steps": of_steps}))
    }

    #[test]
    fn a_silence_counts_while_the_motor_turns_alone() {
        let begun = Instant::now();
        let silent = |line: Option<Line>| {
            let mut watch = Watch::new(begun);
            if let Some(line) = &line {
                watch.hear(line, begun);
            }
            signs(&mut watch, begun, 1, 60).len()
        };
        assert_eq!(silent(None), 0, "it plans");
        assert_eq!(silent(Some(moving(1, 9))), 1);
        assert_eq!(silent(Some(moving(1, 0))), 1, "a run until it is stopped");
        assert_eq!(silent(Some(moving(9, 9))), 0, "it settles");
        assert_eq!(silent(Some(Line::Progress(json!({"pump": "a", "state": "waiting"})))), 0);
    }

    #[test]
    fn a_process_that_does_not_answer_a_stop_is_ended() {
        let begun = Instant::now();
        let mut watch = Watch::new(begun);
        watch.hear(&moving(1, 9), begun);
        watch.stop(begun);
        assert!(!watch.has_ended_it());
        let told = signs(&mut watch, begun, 1, 60);
        let kinds: Vec<(u32, Sign)> =
            told.into_iter().filter(|(_, sign)| !matches!(sign, Sign::Silent(_))).collect();
        assert_eq!(kinds, [(8, Sign::Unanswered), (16, Sign::Killed), (36, Sign::GoesOn)]);
        assert!(watch.has_ended_it());
    }

    #[test]
    fn a_process_that_decelerates_or_tells_a_person_is_left_alone() {
        let begun = Instant::now();
        let mut watch = Watch::new(begun);
        watch.stop(begun);
        for look in 1..40 {
            watch.hear(&moving(u64::from(look), 99), begun + look * LOOK);
            assert_eq!(watch.look(begun + look * LOOK), None);
        }
        watch.hear(&Line::Ending, begun + 40 * LOOK);
        assert_eq!(signs(&mut watch, begun, 40, 119), []);
        assert_eq!(signs(&mut watch, begun, 119, 180)[0], (120, Sign::GoesOn));
    }

    #[test]
    fn a_service_that_was_held_up_itself_takes_no_silence_for_a_fault() {
        let begun = Instant::now();
        let mut watch = Watch::new(begun);
        watch.hear(&moving(1, 9), begun);
        assert_eq!(watch.look(begun + 40 * LOOK), None);
        assert_eq!(signs(&mut watch, begun, 41, 62)[0].0, 60);
    }
}
