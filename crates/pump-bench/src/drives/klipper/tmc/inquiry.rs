//! Questions for the state of a driver whose motor turns. Nobody waits for their answers.

use super::datagram::ANSWER_BYTES;
use super::driver::{TRIES, question, value_of};
use super::error::TmcError;
use super::frames::packed_len;
use super::register::{DRV_STATUS, GSTAT, Register};
use super::status::TmcStatus;

/// Bytes of the bits of an answer.
pub(in crate::drives::klipper) const ANSWER_LEN: usize = packed_len(ANSWER_BYTES);

/// Questions without a usable answer in a row after which nobody knows whether the motor has current. A motor that
/// turns disturbs more of them than one at rest.
const TRIES_IN_MOTION: u32 = 2 * TRIES;

/// Inquiry after the state of a driver: its events, then its flags.
#[derive(Debug)]
pub(in crate::drives::klipper) struct Inquiry {
    address: u8,
    /// Value of GSTAT, once it was answered.
    events: Option<u32>,
    /// Questions without a usable answer in a row, and those of them whose answer was damaged.
    failed: u32,
    damaged: u32,
}

impl Inquiry {
    /// Makes an inquiry after the driver at an address.
    pub(in crate::drives::klipper) fn new(address: u8) -> Self {
        Self { address, events: None, failed: 0, damaged: 0 }
    }

    fn register(&self) -> Register {
        if self.events.is_none() { GSTAT } else { DRV_STATUS }
    }

    /// Returns the bits of the next question.
    pub(in crate::drives::klipper) fn question(&self) -> Vec<u8> {
        question(self.address, self.register())
    }

    /// Takes the bits of an answer. No bits are an answer that did not come. Returns the state of the driver once both
    /// questions are answered; the next inquiry begins then.
    ///
    /// # Errors
    ///
    /// [`TmcError::Reset`] or [`TmcError::Off`] if the motor has lost its current. [`TmcError::FellSilent`] or
    /// [`TmcError::Damaged`] if no question in a row of them has brought an answer.
    pub(in crate::drives::klipper) fn take(&mut self, bits: &[u8]) -> Result<Option<TmcStatus>, TmcError> {
        let Some(value) = value_of(bits, self.register()) else {
            self.failed += 1;
            self.damaged += u32::from(!bits.is_empty());
            return if self.failed < TRIES_IN_MOTION {
                Ok(None)
            } else {
                Err(match self.damaged {
                    0 => TmcError::FellSilent { address: self.address, tries: self.failed },
                    damaged => TmcError::unanswered(self.address, damaged, self.failed),
                })
            };
        };
        (self.failed, self.damaged) = (0, 0);
        let Some(events) = self.events.take() else {
            self.events = Some(value);
            return Ok(None);
        };
        TmcStatus { events, flags: value }.checked(self.address).map(Some)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drives::klipper::tmc::datagram::answer_of;
    use crate::drives::klipper::tmc::frames::pack;

    /// Answer of the driver, in bits.
    fn answer(register: Register, value: u32) -> Vec<u8> {
        pack(&answer_of(register.number, value))
    }

    #[test]
    fn a_driver_is_well_after_both_answers_and_a_fault_is_told() {
        let mut inquiry = Inquiry::new(1);
        let asks = |inquiry: &Inquiry, register| assert_eq!(inquiry.question(), question(1, register));
        asks(&inquiry, GSTAT);
        assert_eq!(inquiry.take(&answer(GSTAT, 0)), Ok(None));
        asks(&inquiry, DRV_STATUS);
        // An answer to the question before is none.
        assert_eq!(inquiry.take(&answer(GSTAT, 0)), Ok(None));
        asks(&inquiry, DRV_STATUS);
        assert!(inquiry.take(&answer(DRV_STATUS, 0)).unwrap().is_some());
        asks(&inquiry, GSTAT);
        inquiry.take(&answer(GSTAT, 0)).unwrap();
        assert!(matches!(inquiry.take(&answer(DRV_STATUS, 2)), Err(TmcError::Off { address: 1, .. })));
        inquiry.take(&answer(GSTAT, 1)).unwrap();
        assert_eq!(inquiry.take(&answer(DRV_STATUS, 0)), Err(TmcError::Reset { address: 1 }));
    }

    #[test]
    fn single_disturbed_answers_are_no_fault_and_a_row_of_them_is() {
        let mut inquiry = Inquiry::new(0);
        for _ in 0..3 {
            assert_eq!(inquiry.take(&[]), Ok(None));
            assert_eq!(inquiry.take(&answer(GSTAT, 0)), Ok(None));
            assert_eq!(inquiry.take(&[0xff; 10]), Ok(None));
            assert!(inquiry.take(&answer(DRV_STATUS, 0)).unwrap().is_some());
        }
        let taken: Vec<_> = (0..6).map(|_| inquiry.take(&[])).collect();
        assert_eq!(taken[..5], [const { Ok(None) }; 5]);
        assert_eq!(taken[5], Err(TmcError::FellSilent { address: 0, tries: 6 }));
    }
}
