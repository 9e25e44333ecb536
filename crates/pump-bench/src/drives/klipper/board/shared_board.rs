//! A board of this process, which the motors of several pumps share.

use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, TryLockError};
use std::time::{Duration, Instant};

use super::commands::Commands;
use crate::drives::board_clock::SharedClock;
use crate::drives::klipper::dictionary::Dictionary;
use crate::drives::klipper::link::SharedTrunk;
use crate::drives::wire::Wire;

/// Longest time for which a motor has the line to the stepper drivers. An answer that has not come by then never does.
const LINE_LIMIT: Duration = Duration::from_secs(1);

/// Board as it was found, for the motors that meet it later.
#[derive(Debug, Clone)]
pub(super) struct Known {
    pub(super) dictionary: Arc<Dictionary>,
    pub(super) format: Arc<Commands>,
    pub(super) clock: SharedClock,
}

/// Board of this process.
#[derive(Debug)]
pub(in crate::drives::klipper) struct SharedBoard {
    pub(in crate::drives::klipper) trunk: Arc<SharedTrunk>,
    known: Mutex<Option<Known>>,
    /// Held by the thread that meets the board, or ends its shutdown.
    meeting: Mutex<()>,
    /// Motor that has a question on the line to the stepper drivers, and the instant of it. The board answers one at a
    /// time, and drops others.
    line: Mutex<Option<(u64, Instant)>>,
    /// Shutdowns that motors of this process have ended. Each has taken the current of every motor.
    cuts: AtomicU32,
}

impl SharedBoard {
    /// Makes the board at the other end of a wire.
    pub(in crate::drives::klipper) fn new(wire: Box<dyn Wire>) -> Self {
        Self {
            trunk: Arc::new(SharedTrunk::new(wire)),
            known: Mutex::default(),
            meeting: Mutex::default(),
            line: Mutex::default(),
            cuts: AtomicU32::new(0),
        }
    }

    /// Lets this thread meet the board, or end its shutdown, unless another one does.
    pub(in crate::drives::klipper) fn try_meeting(&self) -> Option<MutexGuard<'_, ()>> {
        match self.meeting.try_lock() {
            Ok(meeting) => Some(meeting),
            Err(TryLockError::Poisoned(poisoned)) => Some(poisoned.into_inner()),
            Err(TryLockError::WouldBlock) => None,
        }
    }

    /// Returns the number of shutdowns that motors of this process have ended.
    pub(super) fn cuts(&self) -> u32 {
        self.cuts.load(Ordering::SeqCst)
    }

    /// Notes that a motor is about to end a shutdown.
    pub(super) fn note_cut(&self) {
        self.cuts.fetch_add(1, Ordering::SeqCst);
    }

    /// Returns the board as another motor has found it.
    pub(super) fn known(&self) -> Option<Known> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Notes how the board was found.
    pub(super) fn note(&self, known: Known) {
        *self.known.lock().unwrap_or_else(PoisonError::into_inner) = Some(known);
    }

    /// Takes the line to the stepper drivers for a motor. Returns false while another motor has it.
    pub(super) fn take_line(&self, motor: u64) -> bool {
        let mut line = self.line.lock().unwrap_or_else(PoisonError::into_inner);
        let is_taken = line.is_some_and(|(holder, since)| holder != motor && since.elapsed() < LINE_LIMIT);
        if !is_taken {
            *line = Some((motor, Instant::now()));
        }
        !is_taken
    }

    /// Gives the line back that a motor has.
    pub(super) fn free_line(&self, motor: u64) {
        let mut line = self.line.lock().unwrap_or_else(PoisonError::into_inner);
        if line.is_some_and(|(holder, _)| holder == motor) {
            *line = None;
        }
    }
}
