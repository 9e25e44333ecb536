//! The clock of a board, which the motors of the board share.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use super::board_clock::{BoardClock, Within};
use super::error::ClockError;
use super::sample::Reading;

/// Clock that the motors of a board follow together: each reading tells all of them.
#[derive(Debug, Clone)]
pub(in crate::drives) struct SharedClock(Arc<Mutex<Followed>>);

#[derive(Debug)]
struct Followed {
    clock: BoardClock,
    /// Begin in common that was looked up last: its instant, and the tick of the board's clock then.
    begin: Option<(Instant, u64)>,
}

impl SharedClock {
    /// Shares a clock that was read.
    pub(in crate::drives) fn new(clock: BoardClock) -> Self {
        Self(Arc::new(Mutex::new(Followed { clock, begin: None })))
    }

    /// Takes the place of a clock that nobody can follow any more.
    pub(in crate::drives) fn renew(&self, clock: BoardClock) {
        *self.lock() = Followed { clock, begin: None };
    }

    /// Takes a reading, as [`BoardClock::take`] does.
    pub(in crate::drives) fn take(&self, reading: Reading) -> Result<u64, ClockError> {
        self.lock().clock.take(reading)
    }

    /// Returns the clock at a time of the computer's clock, and the ticks by which it may be wrong.
    pub(in crate::drives) fn at(&self, time: Duration) -> Within<u64> {
        self.lock().clock.at(time)
    }

    /// Returns the tick at an instant, which is `time` by the computer's clock. Motors of one board that ask for one
    /// instant get one tick, whatever was read in between.
    pub(in crate::drives) fn tick_at(&self, instant: Instant, time: Duration) -> u64 {
        let mut followed = self.lock();
        match followed.begin {
            Some((begin, tick)) if begin == instant => tick,
            _ => {
                let tick = followed.clock.at(time).value;
                followed.begin = Some((instant, tick));
                tick
            }
        }
    }

    /// Returns the whole clock whose low 32 bits the board told at about a time.
    pub(in crate::drives) fn widen(&self, low: u32, time: Duration) -> Result<u64, ClockError> {
        self.lock().clock.widen(low, time)
    }

    /// Returns the time over which the clock was read.
    pub(in crate::drives) fn span(&self) -> Duration {
        self.lock().clock.span()
    }

    fn lock(&self) -> MutexGuard<'_, Followed> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
