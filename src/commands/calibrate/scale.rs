//! The reading of the scale: a person types it, or a balance says it.

use std::time::Duration;

use pump_bench::Session;
use pump_bench::balance::{Balance, BalanceReading};
use pump_bench::calibration::Reading;

use super::answers::{Answer, Answers};
use crate::failure::Failure;
use crate::interrupt::{self, Interrupt};
use crate::options::balance::BalanceOptions;
use crate::terminal::say;

/// Source of the readings.
pub(super) enum Scale {
    /// A person at the keyboard, or a file in their place.
    Person(Answers),
    /// A balance, with the mass that it showed before the last motion, and the longest wait for it.
    Balance { balance: Box<dyn Balance>, before: Option<BalanceReading>, longest: Duration },
}

impl Scale {
    /// The balance that is named, or else a person.
    pub(super) fn of(options: &BalanceOptions) -> Result<Self, Failure> {
        Ok(match options.open()? {
            Some(balance) => Self::Balance { balance, before: None, longest: options.longest_wait() },
            None => Self::Person(Answers::new()),
        })
    }

    /// Reads the balance before a motion. A person tares the vessel.
    pub(super) fn before(&mut self) -> Result<(), Failure> {
        if let Self::Balance { balance, before, longest } = self {
            *before = Some(still(balance.as_mut(), *longest)?);
        }
        Ok(())
    }

    /// Returns what arrived in the vessel since [`Self::before`].
    pub(super) fn reading(
        &mut self,
        question: &str,
        session: &mut Session<'_>,
        interrupt: &Interrupt,
    ) -> Result<Answer, Failure> {
        match self {
            Self::Person(answers) => answers.reading(question, session, interrupt),
            Self::Balance { balance, before, longest } => {
                let after = still(balance.as_mut(), *longest)?;
                let mass_g = after.mass_g - before.map_or(0.0, |before| before.mass_g);
                say(&format!("{question}: {} more on the balance\n", shown(mass_g, after.step_g)));
                if mass_g <= 0.0 {
                    return Err(Failure::refused(format!(
                        "the balance shows {} of the last run; is the vessel on it, and the line filled?",
                        shown(mass_g, after.step_g)
                    )));
                }
                Ok(Answer::Read(Reading::MassG(mass_g)))
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

    /// True if a reading that cannot be right is asked for again.
    pub(super) fn can_repeat(&self) -> bool {
        matches!(self, Self::Person(_))
    }
}

/// Reads a balance that stands still.
fn still(balance: &mut dyn Balance, longest: Duration) -> Result<BalanceReading, Failure> {
    balance.read_still(longest, &interrupt::stop_request()).map_err(Failure::of)
}

/// A mass with the digits of the balance.
fn shown(mass_g: f64, step_g: f64) -> String {
    let decimals = (-libm::log10(step_g)).clamp(0.0, 6.0).round() as usize;
    format!("{mass_g:.decimals$} g")
}
