//! The watch over the stepper driver of a motor that turns.
//!
//! A driver that switches its motor off tells nobody of itself, and the board goes on counting steps. So the driver is
//! asked again and again, and the steps before the last good answer are those that the motor has made for certain.

use std::time::Duration;

use crate::drives::klipper::board::{Board, Talk, ask_driver};
use crate::drives::klipper::error::KlipperError;
use crate::drives::klipper::link::Arrival;
use crate::drives::klipper::protocol::Message;
use crate::drives::klipper::tmc::{Inquiry, TmcError};

/// Time between two inquiries.
const EVERY: Duration = Duration::from_millis(250);

/// Longest wait for an answer. The board tells of a driver that does not answer within milliseconds, and sends nothing
/// twice.
const ANSWER: Duration = Duration::from_millis(400);

/// Watch over a driver.
#[derive(Debug)]
pub(super) struct DriverWatch {
    inquiry: Inquiry,
    /// Time at which the question under way was asked, and the number of its block.
    asked_at: Option<Duration>,
    asked_in: u64,
    /// True while an inquiry is under way, and the steps that were made when it began.
    inquires: bool,
    made: u64,
    inquired_at: Option<Duration>,
    /// Steps that the motor had current for.
    pub(super) sure: u64,
}

impl DriverWatch {
    /// Makes the watch over the driver at an address, which had no fault before the motion.
    pub(super) fn new(address: u8) -> Self {
        let inquiry = Inquiry::new(address);
        Self { inquiry, asked_at: None, asked_in: 0, inquires: false, made: 0, inquired_at: None, sure: 0 }
    }

    /// Asks what is to be asked now, after `made` steps.
    pub(super) fn go_on(&mut self, board: &mut Board, made: u64) -> Result<(), KlipperError> {
        let now = board.talk.link.now();
        if self.asked_at.is_some_and(|asked| now.saturating_sub(asked) > ANSWER) {
            self.take(&board.talk, &[])?;
        }
        let is_time = self.inquired_at.is_none_or(|at| now.saturating_sub(at) >= EVERY);
        if !self.inquires && is_time {
            (self.inquires, self.made, self.inquired_at) = (true, made, Some(now));
        }
        if self.inquires
            && self.asked_at.is_none()
            && let Some(number) = ask_driver(&mut board.talk, &self.inquiry.question())?
        {
            (self.asked_at, self.asked_in) = (Some(now), number);
        }
        Ok(())
    }

    /// Takes the board's answer.
    pub(super) fn hear(
        &mut self,
        talk: &Talk,
        arrival: &Arrival,
        message: &Message,
    ) -> Result<(), KlipperError> {
        // An answer on the same line that was on its way before is that of another motor's driver.
        let is_own = arrival.taken.is_some_and(|taken| taken >= self.asked_in);
        if self.asked_at.is_some() && is_own {
            self.take(talk, message.bytes("read")?)?;
        }
        Ok(())
    }

    fn take(&mut self, talk: &Talk, bits: &[u8]) -> Result<(), TmcError> {
        self.asked_at = None;
        talk.free_line();
        if self.inquiry.take(bits)?.is_some() {
            (self.inquires, self.sure) = (false, self.made);
        }
        Ok(())
    }
}
