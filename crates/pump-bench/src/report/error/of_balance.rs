//! The facts of errors of balances.

use super::explain::{ErrorFacts, Explain};
use super::kind::ErrorKind;
use crate::balance::BalanceError;
use crate::notice::Remedy;
use crate::report::ending::Ending;

impl Explain for BalanceError {
    fn facts(&self) -> ErrorFacts {
        let facts = ErrorFacts::of(ErrorKind::Balance);
        match self {
            Self::Port { port, .. } | Self::AtBoard { port } => facts.value(port.display()),
            Self::Unanswered { protocol, .. } => facts.value(protocol),
            Self::OtherProtocol { asked, seen, .. } => facts.value(asked).allowed(seen),
            Self::Program { command, .. } | Self::ProgramFailed { command, .. } => facts.value(command),
            Self::Unreadable { said } | Self::NoUnit { said } => {
                facts.value(said).allowed("a number with kg, g or mg")
            }
            Self::OutOfRange { said, .. } | Self::Refused { said } | Self::Unintelligible { said, .. } => {
                facts.value(said)
            }
            Self::NotStill { last, .. } => facts.value(last),
            Self::Silent { .. } => facts,
            Self::Stopped => ErrorFacts::of(ErrorKind::Stopped),
        }
    }

    fn ending(&self) -> Ending {
        Self::ending(self)
    }

    fn remedies(&self) -> Vec<Remedy> {
        self.known_remedies()
    }
}
