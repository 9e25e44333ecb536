//! The answers of a person at the keyboard, or of a file in their place.

use std::io::{self, BufRead};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

use pump_bench::Session;
use pump_bench::calibration::{Reading, Weighing};
use pump_bench::report::ErrorKind;
use pump_bench::units;
use pump_bench::units::{Amount, StatedReading};

use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::terminal::say;

/// Time between two looks for a signal.
const LOOK: Duration = Duration::from_millis(100);

/// Lines of standard input, one question each. They are read beside the program, so that a signal ends a question.
pub(super) struct Answers {
    lines: Receiver<io::Result<String>>,
}

/// An answer to a question for a reading.
pub(super) enum Answer {
    /// A reading, and the step of its last digit in its unit.
    Read(Reading, f64),
    /// Nothing usable was read: repeat the last run.
    Redo,
    /// Leave.
    Quit,
}

impl Answers {
    pub(super) fn new() -> Self {
        let (sender, lines) = channel();
        thread::spawn(move || {
            for line in io::stdin().lock().lines() {
                if sender.send(line).is_err() {
                    return;
                }
            }
        });
        Self { lines }
    }

    /// Asks for what the scale shows until the answer can be used: a mass or a volume, `redo` or `quit`. `example` has
    /// readings as they are typed.
    pub(super) fn reading(
        &self,
        question: &str,
        example: &str,
        session: &mut Session<'_>,
        interrupt: &Interrupt,
    ) -> Result<Answer, Failure> {
        loop {
            say(&format!("{question} (as {example}; redo, quit): "));
            match self.line(session, interrupt)?.trim() {
                "redo" => return Ok(Answer::Redo),
                "quit" => return Ok(Answer::Quit),
                text => match units::stated_reading(text) {
                    Ok(StatedReading { amount, resolution: Amount::Mass(digit) | Amount::Volume(digit) }) => {
                        let reading = match amount {
                            Amount::Mass(mass_g) => Reading::MassG(mass_g),
                            Amount::Volume(volume_ml) => Reading::VolumeMl(volume_ml),
                        };
                        return Ok(Answer::Read(reading, digit));
                    }
                    Err(error) => say(&format!("{error}\n")),
                },
            }
        }
    }

    /// The next line. The end of the input is no answer.
    pub(super) fn line(&self, session: &mut Session<'_>, interrupt: &Interrupt) -> Result<String, Failure> {
        loop {
            if let Some(signal) = interrupt.signal() {
                return Err(Failure::stopped(signal, session.has_moved(), "stopped by the user"));
            }
            session.release_when_due()?;
            match self.lines.recv_timeout(LOOK) {
                Ok(Ok(line)) => return Ok(line),
                Ok(Err(error)) => {
                    return Err(no_answer(session, &format!("the answer cannot be read: {error}")));
                }
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => {
                    return Err(no_answer(session, "the answers ended before the last run"));
                }
            }
        }
    }
}

/// The failure of a question that nobody can answer any more.
fn no_answer(session: &Session<'_>, message: &str) -> Failure {
    Failure::failed(ErrorKind::Input, message).of_session(session)
}

/// Readings as they are typed, near those of an expected volume in mL: a mass, if the density is known, or a volume.
pub(super) fn example(weighing: &Weighing<'_>, expected_ml: f64) -> String {
    let digits = |value: f64, more: usize| format!("{value:.more$e}").parse::<f64>().unwrap_or(value);
    let volume = format!("{}mL", digits(expected_ml, 2));
    match weighing.reading_g(expected_ml) {
        Some(mass_g) => format!("{}g or {volume}", digits(mass_g, 3)),
        None => volume,
    }
}

/// Volume of a reading, mL.
pub(super) fn volume_ml(reading: Reading, weighing: &Weighing<'_>, degc: f64) -> Result<f64, Failure> {
    match reading {
        Reading::VolumeMl(volume_ml) => Ok(volume_ml),
        Reading::MassG(mass_g) => Ok(weighing.volume_ml(mass_g, degc)?),
    }
}
