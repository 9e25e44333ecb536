//! The readings of a balance while the pump turns, taken by a thread of their own.

use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{scope, sleep};
use std::time::{Duration, Instant};

use crate::balance::{Balance, BalanceError, BalanceReading};
use crate::drives::StopRequest;

/// Pause between two readings.
const BETWEEN: Duration = Duration::from_millis(25);

/// Longest wait for one reading.
const LONGEST: Duration = Duration::from_millis(500);

/// Most readings that are kept: those of a minute and a half at the least pause.
const MOST: usize = 4096;

/// Reading with the instant at which it was had.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    pub(super) at: Instant,
    pub(super) reading: BalanceReading,
}

/// Readings so far.
#[derive(Debug, Default)]
struct Seen {
    samples: VecDeque<Sample>,
    /// Time for which the balance was listened to since its last reading.
    silent: Duration,
    fault: Option<BalanceError>,
}

/// Readings of a balance while something else happens.
#[derive(Debug, Default)]
pub(super) struct Readings {
    seen: Mutex<Seen>,
}

impl Readings {
    fn seen(&self) -> MutexGuard<'_, Seen> {
        self.seen.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Reads `balance` over and over while `during` runs. The user's `stop` ends a reading under way.
    pub(super) fn while_running<T>(
        balance: &mut dyn Balance,
        stop: &StopRequest,
        during: impl FnOnce(&Self) -> T,
    ) -> T {
        let (readings, ends) = (Self::default(), Arc::new(AtomicBool::new(false)));
        scope(|scope| {
            let ends_soon = Ends(Arc::clone(&ends));
            let reader = &readings;
            let (ended, stop) = (Arc::clone(&ends), stop.clone());
            scope.spawn(move || {
                let over = Arc::clone(&ended);
                let stop = StopRequest::new(move || over.load(Ordering::Relaxed) || stop.is_made());
                while !ended.load(Ordering::Relaxed) && reader.take(balance, &stop) {
                    sleep(BETWEEN);
                }
            });
            let found = during(&readings);
            drop(ends_soon);
            found
        })
    }

    /// Takes one reading. Returns false after an error that ends the dose.
    fn take(&self, balance: &mut dyn Balance, stop: &StopRequest) -> bool {
        let asked = Instant::now();
        let read = balance.read_now(LONGEST, stop);
        let listened = asked.elapsed().min(LONGEST);
        let mut seen = self.seen();
        match read {
            Ok(reading) => {
                seen.silent = Duration::ZERO;
                if seen.samples.len() == MOST {
                    seen.samples.pop_front();
                }
                seen.samples.push_back(Sample { at: Instant::now(), reading });
                true
            }
            // A wait counts for no more than it was to last: a busy computer is no silent balance.
            Err(
                BalanceError::Silent { .. }
                | BalanceError::Unanswered { .. }
                | BalanceError::Unintelligible { .. }
                | BalanceError::NotStill { .. },
            ) => {
                seen.silent += listened + BETWEEN;
                true
            }
            Err(BalanceError::Stopped) => false,
            Err(error) => {
                seen.fault = Some(error);
                false
            }
        }
    }

    /// Returns the last reading.
    pub(super) fn last(&self) -> Option<Sample> {
        self.seen().samples.back().copied()
    }

    /// Returns the time for which the balance was listened to since its last reading.
    pub(super) fn silent(&self) -> Duration {
        self.seen().silent
    }

    /// Returns the last reading up to an instant.
    pub(super) fn last_until(&self, at: Instant) -> Option<Sample> {
        self.seen().samples.iter().rev().find(|sample| sample.at <= at).copied()
    }

    /// Takes the error of the balance, if it has one.
    pub(super) fn take_fault(&self) -> Option<BalanceError> {
        self.seen().fault.take()
    }
}

/// Ends the reading thread when it is dropped, also where the motion panics.
struct Ends(Arc<AtomicBool>);

impl Drop for Ends {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Balance that takes its time and then answers.
    #[derive(Debug)]
    struct Slow {
        takes: Duration,
        answers: bool,
    }

    impl Balance for Slow {
        fn read_still(&mut self, within: Duration, _: &StopRequest) -> Result<BalanceReading, BalanceError> {
            sleep(self.takes);
            let reading = BalanceReading { mass_g: 1.0, step_g: 0.01 };
            if self.answers { Ok(reading) } else { Err(BalanceError::Silent { within }) }
        }
    }

    #[test]
    fn a_balance_is_silent_for_as_long_as_it_was_listened_to() {
        let (readings, stop) = (Readings::default(), StopRequest::default());
        let silent_s = |takes_ms, answers| {
            assert!(readings.take(&mut Slow { takes: Duration::from_millis(takes_ms), answers }, &stop));
            readings.silent().as_secs_f64()
        };
        // A busy computer returns late from a wait of half a second: no more than that counts, and the pause.
        assert!((silent_s(1200, false) - 0.525).abs() < 1e-6);
        assert!((silent_s(600, false) - 1.05).abs() < 1e-6);
        // A reading that comes late is a reading.
        assert_eq!(silent_s(900, true), 0.0);
        assert!((silent_s(700, false) - 0.525).abs() < 1e-6);
    }
}
