//! The clock that all pumps of a rack share, and the stop that ends them all.

use std::collections::BTreeSet;
use std::ops::ControlFlow;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::drives::StopRequest;
use crate::pump_file::Pace;

/// Longest sleep between two looks for a stop.
const SLICE: Duration = Duration::from_millis(10);

/// Time by which a simulated pump may be ahead of the slowest one, in s, and of the clock where it keeps real time.
const AHEAD_S: f64 = 0.01;

/// Cause of a stop of all pumps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Stop {
    /// Somebody asked for it.
    Asked,
    /// The pump of this number refuses its part, and nothing has moved. Pumps before it in the rack go on to say
    /// whether they refuse theirs.
    Refused(usize),
    /// The pump of this number failed.
    Fault(usize),
}

/// Stop that all pumps of a rack hear.
#[derive(Debug, Clone, Default)]
pub(super) struct SharedStop {
    asked: StopRequest,
    /// Names of the pumps.
    pumps: Arc<[String]>,
    made: Arc<Mutex<Option<Stop>>>,
    /// Pumps that wait for a person, whose boards are still to tell their counts.
    counted: Arc<Mutex<BTreeSet<usize>>>,
}

impl SharedStop {
    /// Makes a stop of the pumps of these names that `asked` makes too.
    pub(super) fn hearing(asked: StopRequest, pumps: Arc<[String]>) -> Self {
        Self { asked, pumps, made: Arc::default(), counted: Arc::default() }
    }

    /// Lets a pump go on that waits for a person, although another one refuses: its board is still to tell its count.
    pub(super) fn let_count(&self, pump: usize) {
        self.counted.lock().unwrap_or_else(PoisonError::into_inner).insert(pump);
    }

    /// Stops all pumps. The first cause stays, and the first pump of those that refuse.
    pub(super) fn make(&self, cause: Stop) {
        let mut made = self.lock();
        *made = Some(match (*made, cause) {
            (Some(Stop::Refused(first)), Stop::Refused(pump)) => Stop::Refused(first.min(pump)),
            (made, cause) => made.unwrap_or(cause),
        });
    }

    /// Returns the cause of the stop, once there is one.
    pub(super) fn cause(&self) -> Option<Stop> {
        let mut made = self.lock();
        if made.is_none() && self.asked.is_made() {
            *made = Some(Stop::Asked);
        }
        *made
    }

    /// Returns the request to stop that ends the waits of a pump for its record and its device.
    pub(super) fn request(&self, pump: usize) -> StopRequest {
        let (stop, told, failed) = (self.clone(), self.clone(), self.clone());
        StopRequest::new(move || stop.is_heard_by(pump))
            .saying(move || told.said())
            .by_others(move || matches!(failed.cause(), Some(Stop::Fault(_) | Stop::Refused(_))))
    }

    /// Returns true if the waits of a pump are to end. A refusal ends those of the pumps after it alone, so the same
    /// pump is named in every run: the first in the order of the rack. A pump whose board is to tell its count goes on.
    fn is_heard_by(&self, pump: usize) -> bool {
        match self.cause() {
            Some(Stop::Refused(first)) => (pump > first && !self.counts(pump)) || self.asked.is_made(),
            cause => cause.is_some(),
        }
    }

    fn counts(&self, pump: usize) -> bool {
        self.counted.lock().unwrap_or_else(PoisonError::into_inner).contains(&pump)
    }

    /// Returns who or what stopped all pumps, as the log of each keeps it.
    fn said(&self) -> Option<String> {
        match self.cause()? {
            Stop::Asked => self.asked.cause(),
            Stop::Fault(pump) | Stop::Refused(pump) => {
                Some(format!("a fault of pump {} of the rack", self.pumps.get(pump)?))
            }
        }
    }

    fn lock(&self) -> MutexGuard<'_, Option<Stop>> {
        self.made.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Clock of a rack under way.
#[derive(Debug)]
pub(super) struct RackClock {
    pace: Pace,
    began: Instant,
    stop: SharedStop,
    /// Times that the pumps have reached, in s. Infinite for a pump that is done.
    reached_s: Mutex<Vec<f64>>,
    moved_on: Condvar,
    /// Shares whose motions are on record: the number of the step and of the pump of each.
    announced: Mutex<BTreeSet<(usize, usize)>>,
    announced_more: Condvar,
}

impl RackClock {
    /// Makes a clock for so many pumps that begins `lead` from now.
    pub(super) fn new(pace: Pace, pumps: usize, lead: Duration, stop: SharedStop) -> Self {
        let (reached_s, moved_on) = (Mutex::new(vec![0.0; pumps]), Condvar::new());
        let (announced, announced_more) = Default::default();
        Self { pace, began: Instant::now() + lead, stop, reached_s, moved_on, announced, announced_more }
    }

    /// Waits until the time of the rack is `time_s`, for a simulated pump up to a hundredth of a second before. Breaks
    /// once all are to stop.
    pub(super) fn reach(&self, pump: usize, time_s: f64) -> ControlFlow<()> {
        match self.pace {
            Pace::Real => self.sleep_until(time_s),
            Pace::Fast => self.keep_step(pump, time_s),
        }
    }

    /// Says that a pump's share of a step is on record, and waits until those of all its pumps are. Breaks once all are
    /// to stop, or a pump has left without its share.
    pub(super) fn meet(&self, pump: usize, step: usize, pumps: &[usize]) -> ControlFlow<()> {
        let mut announced = self.announced.lock().unwrap_or_else(PoisonError::into_inner);
        announced.insert((step, pump));
        self.announced_more.notify_all();
        loop {
            self.flow()?;
            let mut missing = pumps.iter().filter(|pump| !announced.contains(&(step, **pump))).peekable();
            if missing.peek().is_none() {
                return ControlFlow::Continue(());
            }
            if missing.any(|pump| self.lock().get(*pump).is_none_or(|reached_s| reached_s.is_infinite())) {
                return ControlFlow::Break(());
            }
            let waited = self.announced_more.wait_timeout(announced, SLICE);
            announced = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    /// Breaks once all are to stop.
    pub(super) fn flow(&self) -> ControlFlow<()> {
        if self.stop.cause().is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    /// Returns the time of the rack, in s: that of its slowest pump where no real time is kept. Infinite once all are
    /// done.
    pub(super) fn now_s(&self) -> f64 {
        match self.pace {
            Pace::Real => {
                let now = Instant::now();
                let before_s = self.began.saturating_duration_since(now).as_secs_f64();
                now.saturating_duration_since(self.began).as_secs_f64() - before_s
            }
            Pace::Fast => slowest_s(&self.lock()),
        }
    }

    /// Says that a pump is done, so that none waits for it.
    pub(super) fn leave(&self, pump: usize) {
        self.note(&mut self.lock(), pump, f64::INFINITY);
    }

    fn sleep_until(&self, time_s: f64) -> ControlFlow<()> {
        loop {
            self.flow()?;
            let left_s = time_s - self.now_s();
            // A sleep for each of many thousand steps a second would make them late.
            if left_s <= 0.0 || (time_s > 0.0 && left_s < AHEAD_S / 10.0) {
                return ControlFlow::Continue(());
            }
            sleep(SLICE.min(Duration::try_from_secs_f64(left_s).unwrap_or(SLICE)));
        }
    }

    fn keep_step(&self, pump: usize, time_s: f64) -> ControlFlow<()> {
        let mut reached_s = self.lock();
        self.note(&mut reached_s, pump, time_s);
        loop {
            self.flow()?;
            if slowest_s(&reached_s) + AHEAD_S >= time_s {
                return ControlFlow::Continue(());
            }
            let waited = self.moved_on.wait_timeout(reached_s, SLICE);
            reached_s = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    fn note(&self, reached_s: &mut [f64], pump: usize, time_s: f64) {
        let before_s = slowest_s(reached_s);
        if let Some(reached_s) = reached_s.get_mut(pump) {
            *reached_s = time_s;
        }
        if slowest_s(reached_s) > before_s {
            self.moved_on.notify_all();
        }
    }

    fn lock(&self) -> MutexGuard<'_, Vec<f64>> {
        self.reached_s.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn slowest_s(reached_s: &[f64]) -> f64 {
    reached_s.iter().copied().fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_cause_of_a_stop_stays_and_ends_every_wait() {
        let stop = SharedStop::default();
        let clock = RackClock::new(Pace::Fast, 2, Duration::ZERO, stop.clone());
        assert_eq!(clock.reach(0, 0.005), ControlFlow::Continue(()));
        stop.make(Stop::Fault(1));
        stop.make(Stop::Asked);
        // Pump 1 stands at 0 s for ever.
        assert_eq!((clock.reach(0, 1e9), stop.cause()), (ControlFlow::Break(()), Some(Stop::Fault(1))));
    }

    #[test]
    fn a_fast_pump_waits_for_the_slowest_and_for_none_that_is_done() {
        let clock = RackClock::new(Pace::Fast, 2, Duration::ZERO, SharedStop::default());
        std::thread::scope(|scope| {
            let fast = scope.spawn(|| {
                let went_on = clock.reach(0, 1.0);
                (went_on, clock.lock()[1])
            });
            assert_eq!(clock.reach(1, 0.4), ControlFlow::Continue(()));
            clock.leave(1);
            assert_eq!(fast.join().unwrap(), (ControlFlow::Continue(()), f64::INFINITY));
        });
        assert_eq!(clock.now_s(), 1.0);
    }

    #[test]
    fn no_share_begins_before_all_are_on_record_or_after_a_pump_has_left() {
        let clock = RackClock::new(Pace::Fast, 3, Duration::ZERO, SharedStop::default());
        std::thread::scope(|scope| {
            let waits = scope.spawn(|| clock.meet(0, 4, &[0, 1]));
            // An earlier step's share is another one.
            assert_eq!(clock.meet(1, 3, &[1]), ControlFlow::Continue(()));
            sleep(3 * SLICE);
            assert!(!waits.is_finished());
            assert_eq!(clock.meet(1, 4, &[0, 1]), ControlFlow::Continue(()));
            assert_eq!(waits.join().unwrap(), ControlFlow::Continue(()));
            let alone = scope.spawn(|| clock.meet(0, 5, &[0, 2]));
            clock.leave(2);
            assert_eq!(alone.join().unwrap(), ControlFlow::Break(()));
        });
    }
}
