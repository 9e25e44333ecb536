//! Balances that say what they show: over a serial port, or by a program that prints it.
//!
//! A balance is read once it says that it stands still, or once its readings agree where it has no word for that. Every
//! wait has a deadline and hears the user's stop.

mod agreement;
mod error;
mod own_port;
mod program;
mod reading;
#[cfg(feature = "balance")]
mod serial;
mod words;

use std::fmt::Debug;
use std::time::Duration;

pub use agreement::agreeing;
pub use error::BalanceError;
pub use own_port::refuse_port_of_board;
pub use program::ProgramBalance;
pub use reading::{BalanceReading, printed_reading};
#[cfg(feature = "balance")]
pub use serial::{Framing, Protocol, SerialBalance, SerialLine};

use crate::drives::StopRequest;

/// Balance under the vessel.
pub trait Balance: Debug + Send {
    /// Returns what the balance shows once it stands still.
    ///
    /// # Errors
    ///
    /// [`BalanceError::NotStill`] or [`BalanceError::Silent`] if it does not say so within `longest`,
    /// [`BalanceError::Stopped`] if the user asks to stop. Other errors of the balance as soon as it tells them.
    fn read_still(&mut self, longest: Duration, stop: &StopRequest) -> Result<BalanceReading, BalanceError>;

    /// Returns what the balance shows now, whether it stands still or not. A dose by weight asks this over and over
    /// while the pump turns.
    ///
    /// A balance that has only [`Self::read_still`] is asked by it. It must then answer at once.
    ///
    /// # Errors
    ///
    /// [`BalanceError::Silent`] if the balance shows nothing within `longest`, [`BalanceError::Stopped`] if `stop` is
    /// made. Other errors of the balance as soon as it tells them.
    fn read_now(&mut self, longest: Duration, stop: &StopRequest) -> Result<BalanceReading, BalanceError> {
        self.read_still(longest, stop)
    }
}
