//! The reading of the scale: a person types it, or a balance says it.

use std::time::Duration;

use pump_bench::balance::{Balance, BalanceReading};
use pump_bench::calibration::Reading;
use pump_bench::{Bench, Session};

use super::answers::{Answer, Answers};
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::options::balance::{BalanceOptions, read_still};
use crate::terminal::say;

/// Source of the readings.
pub(super) enum Scale {
    /// A person at the keyboard, or a file in their place.
    Person(Answers),
    /// A balance, with the mass that it showed before the last motion, and the longest wait for it.
    Balance {
        balance: Box<dyn Balance>,
        before: Option<BalanceReading>,
        longest: Duration,
        /// Largest step of the last digit that was seen, in g.
        digit_g: f64,
    },
}

impl Scale {
    /// The balance that is named, or else a person.
    pub(super) fn of(bench: &Bench, options: &BalanceOptions) -> Result<Self, Failure> {
        Ok(match options.open(bench.board_port())? {
            Some(balance) => {
                Self::Balance { balance, before: None, longest: options.longest_wait(), digit_g: 0.0 }
            }
            None => Self::Person(Answers::new()),
        })
    }

    /// Reads the balance before a motion. A person tares the vessel.
    pub(super) fn before(&mut self) -> Result<(), Failure> {
        if let Self::Balance { balance, before, longest, .. } = self {
            *before = Some(read_still(balance.as_mut(), *longest)?);
        }
        Ok(())
    }

    /// Returns what arrived in the vessel since [`Self::before`]. `example` has readings as a
    /// person types them.
    pub(super) fn reading(
        &mut self,
        question: &str,
        example: &str,
        session: &mut Session<'_>,
        interrupt: &Interrupt,
    ) -> Result<Answer, Failure> {
        match self {
            Self::Person(answers) => answers.reading(question, example, session, interrupt),
            Self::Balance { balance, before, longest, digit_g } => {
                let after = read_still(balance.as_mut(), *longest)?;
                *digit_g = digit_g.max(after.step_g);
                let mass_g = after.mass_g - before.map_or(0.0, |before| before.mass_g);
                say(&format!("{question}: {} more on the balance\n", shown(mass_g, after.step_g)));
                if mass_g <= 0.0 {
                    return Err(Failure::refused(format!(
                        "the balance shows {} of the last run; is the vessel on it, and the line filled?",
                        shown(mass_g, after.step_g)
                    )));
                }
                Ok(Answer::Read(Reading::MassG(mass_g), after.step_g))
            }
        }
    }

    /// Returns the answer of a person to a question, and of a balance this one.
    pub(super) fn line(
        &mut self,
        session: &mut Session<'_>,
        interrupt: &Interrupt,
        of_balance: &str,
    ) -> Result<String, Failure> {
        match self {
            Self::Person(answers) => answers.line(session, interrupt),
            Self::Balance { .. } => {
                say(&format!("{of_balance}\n"));
                Ok(of_balance.to_owned())
            }
        }
    }

    /// The step of the balance's last digit, in g, once it was read.
    pub(super) fn digit_g(&self) -> Option<f64> {
        match self {
            Self::Balance { digit_g, .. } if *digit_g > 0.0 => Some(*digit_g),
            Self::Balance { .. } | Self::Person(_) => None,
        }
    }

    /// True if a reading that cannot be right is asked for again.
    pub(super) fn can_repeat(&self) -> bool {
        matches!(self, Self::Person(_))
    }
}

/// A mass with the digits of the balance.
pub(super) fn shown(mass_g: f64, step_g: f64) -> String {
    BalanceReading { mass_g, step_g }.shown()
}

/// The words on how sure a reading with this last digit is, unless the user says it.
pub(super) fn digits_said(step_g: f64, is_stated: bool) -> String {
    if is_stated {
        return String::new();
    }
    let standard_g = BalanceReading { mass_g: 0.0, step_g }.difference_standard_g();
    format!("; by its last digit it is sure to {standard_g:.1e} g (--scale says it otherwise)")
}
