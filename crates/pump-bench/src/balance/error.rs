//! Errors of balances.

use std::io;
use std::path::PathBuf;
use std::time::Duration;

use thiserror::Error;

/// A balance that cannot be read. Nothing moves because of it.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum BalanceError {
    /// The serial port cannot be opened or used.
    #[error("cannot {action} the balance at {}", .port.display())]
    Port {
        /// Action that was tried.
        action: &'static str,
        /// Port of the balance.
        port: PathBuf,
        /// Cause of the failure.
        source: io::Error,
    },
    /// The program cannot be started.
    #[error("cannot start `{command}`, which reads the balance")]
    Program {
        /// Command that was given.
        command: String,
        /// Cause of the failure.
        source: io::Error,
    },
    /// The program ended with an error.
    #[error("`{command}`, which reads the balance, failed: {said}")]
    ProgramFailed {
        /// Command that was given.
        command: String,
        /// Exit status, and the last line that the program wrote on standard error.
        said: String,
    },
    /// The balance said nothing in time.
    #[error("the balance said nothing within {} s", .within.as_secs())]
    Silent {
        /// Time that was waited.
        within: Duration,
    },
    /// The balance at a serial port did not answer the questions of its protocol in time.
    #[error("the balance said nothing within {} s when it was asked in {protocol}", .within.as_secs())]
    Unanswered {
        /// Time that was waited.
        within: Duration,
        /// Name of the protocol.
        protocol: &'static str,
    },
    /// The balance at a serial port sent nothing that its protocol has.
    #[error(
        "the balance was asked in {protocol}, and within {} s it sent only `{said}`, which {protocol} does not have",
        .within.as_secs()
    )]
    Unintelligible {
        /// Time that was waited.
        within: Duration,
        /// Name of the protocol.
        protocol: &'static str,
        /// Last words or bytes of the balance.
        said: String,
    },
    /// The balance answers in another protocol than it was asked in.
    #[error("the balance was asked in {asked} and said `{said}`, which is {seen}")]
    OtherProtocol {
        /// Name of the protocol of the question.
        asked: &'static str,
        /// Name of the protocol of the answer.
        seen: &'static str,
        /// Words of the balance.
        said: String,
    },
    /// The port of the balance is that of the pump's board.
    #[error("{} is the port of the pump's board: the balance has one of its own", .port.display())]
    AtBoard {
        /// Port that was named for the balance.
        port: PathBuf,
    },
    /// The balance did not come to rest in time.
    #[error("the balance did not stand still within {} s; it last showed `{last}`", .within.as_secs())]
    NotStill {
        /// Time that was waited.
        within: Duration,
        /// Last words of the balance.
        last: String,
    },
    /// The balance said something that is no reading.
    #[error("the balance said `{said}`, which is no mass; allowed: a number with kg, g or mg")]
    Unreadable {
        /// Words of the balance.
        said: String,
    },
    /// The balance said a number without a unit.
    #[error("the balance said `{said}`, a number without a unit; print `{said} g`, or with kg or mg")]
    NoUnit {
        /// Words of the balance.
        said: String,
    },
    /// The load is outside the range of the balance.
    #[error("the balance is {state}: it said `{said}`")]
    OutOfRange {
        /// State of the balance: overloaded or underloaded.
        state: &'static str,
        /// Words of the balance.
        said: String,
    },
    /// The balance refused the question.
    #[error("the balance refused the question twice: it said `{said}`")]
    Refused {
        /// Words of the balance.
        said: String,
    },
    /// The user asked to stop.
    #[error("stopped by the user while the balance was read")]
    Stopped,
}
