//! Questions to a person at the keyboard, or to a file in their place.

use std::io::{self, BufRead, IsTerminal};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::terminal::{say, say_wrapped};

/// Time between two looks for a signal.
const LOOK: Duration = Duration::from_millis(100);

/// The end of a course before its last step.
pub(super) enum Stop {
    /// The person leaves, and will come back.
    Left,
    /// The person wants the previous question.
    Back,
    /// Something is wrong.
    Failed(Failure),
}

/// Answer, or the end of the course.
pub(super) type Asked<T> = Result<T, Stop>;

impl<F: Into<Failure>> From<F> for Stop {
    fn from(failure: F) -> Self {
        Self::Failed(failure.into())
    }
}

/// A question, with the option that answers it too.
pub(super) struct Question<'a> {
    /// Question itself, without a question mark.
    pub(super) text: &'a str,
    /// Option that gives the answer, as `--rollers 3`.
    pub(super) option: &'a str,
    /// Answer that the Enter key gives, and where it comes from.
    pub(super) usual: Option<Usual>,
    /// Words for somebody who asks for more.
    pub(super) help: &'a str,
}

/// Answer that is suggested.
#[derive(Clone)]
pub(super) struct Usual {
    /// Answer, as it would be typed.
    pub(super) answer: String,
    /// Pump whose answer it was, if it was one's.
    pub(super) of: Option<String>,
}

impl Usual {
    /// The answer that most pumps have.
    pub(super) fn new(answer: impl Into<String>) -> Self {
        Self { answer: answer.into(), of: None }
    }
}

/// Person who answers questions.
pub(super) struct Asker {
    lines: Option<Receiver<io::Result<String>>>,
    /// True if nobody is asked: suggested answers are taken.
    yes: bool,
    is_terminal: bool,
    interrupt: Interrupt,
}

impl Asker {
    /// Someone at the keyboard. With `yes` nobody is asked.
    pub(super) fn new(yes: bool) -> Result<Self, Failure> {
        let interrupt = Interrupt::watch()?;
        Ok(Self { lines: None, yes, is_terminal: io::stdin().is_terminal(), interrupt })
    }

    /// The watch for signals.
    pub(super) fn interrupt(&self) -> &Interrupt {
        &self.interrupt
    }

    /// True if nobody is asked.
    pub(super) fn is_silent(&self) -> bool {
        self.yes
    }

    /// True if a person at a terminal is asked, and not a script whose answers are piped in.
    pub(super) fn asks_person(&self) -> bool {
        self.is_terminal && !self.yes
    }

    /// Asks until `read` takes the answer. It says why it does not.
    pub(super) fn ask<T>(
        &mut self,
        question: &Question<'_>,
        mut read: impl FnMut(&str) -> Result<T, String>,
    ) -> Asked<T> {
        let usual = question.usual.as_ref();
        if self.yes {
            let Some(usual) = usual else { return Err(unanswered(question, "nobody is asked").into()) };
            let value = read(&usual.answer).map_err(|why| {
                Stop::Failed(Failure::refused(format!("{}: {why}; say {}", question.text, question.option)))
            })?;
            say_taken(question, usual);
            return Ok(value);
        }
        loop {
            let suggested = match usual {
                Some(Usual { answer, of: Some(pump) }) => format!(" [{answer}, as of {pump}]"),
                Some(Usual { answer, of: None }) => format!(" [{answer}]"),
                None => String::new(),
            };
            say(&format!("{}{suggested}: ", question.text));
            let line = self.line(question)?;
            if !self.is_terminal {
                // Nobody has typed the answer where the question stands.
                say(&format!("{line}\n"));
            }
            let answer = match (line.trim(), usual) {
                ("", Some(usual)) => usual.answer.as_str(),
                ("", None) => {
                    say_wrapped(&format!("  Enter alone answers nothing here: {}\n", question.help));
                    continue;
                }
                ("?", _) => {
                    say_wrapped(&format!("  {}\n", question.help));
                    continue;
                }
                ("quit", _) => return Err(Stop::Left),
                ("back", _) => return Err(Stop::Back),
                (answer, _) => answer,
            };
            match read(answer) {
                Ok(value) => return Ok(value),
                Err(why) => say_wrapped(&format!("  {why}\n")),
            }
        }
    }

    /// Asks a question that yes or no answers.
    pub(super) fn agrees(&mut self, question: &Question<'_>) -> Asked<bool> {
        self.ask(question, |answer| {
            yes_or_no(answer).ok_or_else(|| format!("`{answer}` is neither yes nor no"))
        })
    }

    /// The next line. The end of the input is no answer.
    fn line(&mut self, question: &Question<'_>) -> Result<String, Failure> {
        let lines = self.lines.get_or_insert_with(lines);
        loop {
            if let Some(signal) = self.interrupt.signal() {
                say("\n");
                return Err(Failure::stopped(signal, false, "stopped by the user"));
            }
            match lines.recv_timeout(LOOK) {
                Ok(Ok(line)) => return Ok(line),
                Ok(Err(error)) => {
                    return Err(unanswered(question, &format!("the answer cannot be read ({error})")));
                }
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => {
                    say("\n");
                    return Err(unanswered(question, "the answers have ended"));
                }
            }
        }
    }
}

/// Says which answer was taken without a question, and where it comes from. A yes is what `--yes` says itself.
fn say_taken(question: &Question<'_>, usual: &Usual) {
    if usual.answer == "yes" {
        return;
    }
    let of = usual.of.as_ref().map_or_else(String::new, |pump| format!(" as of {pump}"));
    say_wrapped(&format!("  {}: {}{of}, taken by --yes\n", question.text, usual.answer));
}

/// Reads yes or no.
pub(super) fn yes_or_no(answer: &str) -> Option<bool> {
    match answer.to_lowercase().as_str() {
        "y" | "yes" => Some(true),
        "n" | "no" => Some(false),
        _ => None,
    }
}

/// The failure of a question that nobody answers. It names the option.
fn unanswered(question: &Question<'_>, why: &str) -> Failure {
    let (text, option) = (question.text, question.option);
    Failure::refused(format!("no answer to \"{text}\": {why}; say {option}")).value(text).allowed(option)
}

/// Reads lines beside the program, so that a signal ends a question.
fn lines() -> Receiver<io::Result<String>> {
    let (sender, lines) = channel();
    thread::spawn(move || {
        for line in io::stdin().lock().lines() {
            if sender.send(line).is_err() {
                return;
            }
        }
    });
    lines
}
