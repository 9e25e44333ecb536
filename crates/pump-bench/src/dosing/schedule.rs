//! The schedule of a batch: the time at which each dose is due.

use std::time::Duration;

use pump_model::{Allowed, Shown};
use thiserror::Error;

use crate::words::words;

/// Most doses of a batch.
pub const MAX_DOSES: u32 = 1_000_000;

/// Shortest and longest time from the start of a dose to the start of the next, in s.
const EVERY_S: [f64; 2] = [1e-3, 366.0 * 86_400.0];

/// Numbers of doses as a refusal words them, with all digits.
const DOSES_ALLOWED: Allowed = Allowed::Words("1 to 1000000");

/// Times between doses as a refusal words them, with all digits.
const EVERY_ALLOWED: Allowed = Allowed::Words("0.001 to 31622400");

/// Lateness from which on an awaited dose is missed, or the interval if that is shorter. The process must
/// have been suspended.
const LATEST: Duration = Duration::from_secs(1);

/// Choice of what happens to a dose whose time has passed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Missed {
    /// The dose is left out.
    #[default]
    Skip,
    /// The dose is made at once.
    Now,
}

words!(Missed { Skip = "skip", Now = "now" });

/// Next action of a batch. Doses are numbered from 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ScheduleAction {
    /// Wait until this time on the schedule's clock.
    Wait(Duration),
    /// Make the dose of this number.
    Dose(u64),
    /// Leave out the dose of this number: its time has passed.
    Skip(u64),
    /// Stop: every dose was made or left out.
    Done,
}

pump_model::named_quantities! {
    /// Quantity of a schedule that has an allowed range. `Display` writes its name, with its unit if it has one.
    pub enum ScheduleParameter {
        Doses = "number of doses",
        Interval = "time between doses in s",
    }
}

/// Schedule that cannot be kept.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[non_exhaustive]
pub enum ScheduleError {
    /// A value is outside its range.
    #[error("{parameter} is {}; allowed: {allowed}", Shown(*value))]
    OutOfRange {
        /// Quantity that was given.
        parameter: ScheduleParameter,
        /// Value that was given.
        value: f64,
        /// Values that are accepted.
        allowed: Allowed,
    },
}

/// Schedule of a batch, counted from the batch's start. The schedule never sleeps and reads no clock.
///
/// The caller's clock must never be set, as [`std::time::Instant`] never is. On Linux that clock stands still
/// while the machine sleeps, and the batch with it. A process that alone is suspended misses doses.
///
/// ```
/// use std::time::Duration;
///
/// use pump_bench::dosing::{Missed, Schedule, ScheduleAction};
///
/// let mut schedule = Schedule::new(3, Some(10.0), Missed::Skip)?;
/// let at = Duration::from_secs;
/// assert_eq!(schedule.next(at(0)), ScheduleAction::Dose(1));
/// // The first dose took 12 s: the second one's time has passed.
/// assert_eq!(schedule.next(at(12)), ScheduleAction::Skip(2));
/// assert_eq!(schedule.next(at(12)), ScheduleAction::Wait(at(20)));
/// assert_eq!(schedule.next(at(20)), ScheduleAction::Dose(3));
/// assert_eq!(schedule.next(at(21)), ScheduleAction::Done);
/// # Ok::<(), pump_bench::dosing::ScheduleError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Schedule {
    count: u64,
    /// Interval from start to start. `None` makes each dose when the one before is done.
    every: Option<Duration>,
    missed: Missed,
    /// Number of doses made or left out.
    past: u64,
    /// True if the next dose was not due yet when the schedule was last asked.
    in_time: bool,
}

impl Schedule {
    /// Returns the number of doses made or left out.
    pub fn past(&self) -> u64 {
        self.past
    }

    /// Plans `count` doses, one every `every_s` seconds from start to start. Without an interval each dose
    /// follows the one before.
    ///
    /// # Errors
    ///
    /// [`ScheduleError::OutOfRange`] if the number of doses or the interval is outside its range.
    pub fn new(count: u64, every_s: Option<f64>, missed: Missed) -> Result<Self, ScheduleError> {
        if !(1..=u64::from(MAX_DOSES)).contains(&count) {
            let (parameter, value) = (ScheduleParameter::Doses, count as f64);
            return Err(ScheduleError::OutOfRange { parameter, value, allowed: DOSES_ALLOWED });
        }
        let [least, most] = EVERY_S;
        if let Some(value) = every_s.filter(|every_s| !(least..=most).contains(every_s)) {
            let parameter = ScheduleParameter::Interval;
            return Err(ScheduleError::OutOfRange { parameter, value, allowed: EVERY_ALLOWED });
        }
        let every = every_s.map(Duration::from_secs_f64);
        Ok(Self { count, every, missed, past: 0, in_time: true })
    }

    /// Returns the number of doses.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Returns the time at which dose `number` is due, from the batch's start.
    pub(crate) fn due(&self, number: u64) -> Duration {
        self.every.map_or(Duration::ZERO, |every| {
            let nanoseconds = every.as_nanos() * u128::from(number.saturating_sub(1));
            let (seconds, rest) = (nanoseconds / 1_000_000_000, nanoseconds % 1_000_000_000);
            Duration::new(u64::try_from(seconds).unwrap_or(u64::MAX), rest as u32)
        })
    }

    /// Returns the action at `now`, the time since the batch's start. Each dose or skip is returned once and
    /// then counts as past.
    pub fn next(&mut self, now: Duration) -> ScheduleAction {
        if self.past == self.count {
            return ScheduleAction::Done;
        }
        let number = self.past + 1;
        let due = self.due(number);
        if now < due {
            self.in_time = true;
            return ScheduleAction::Wait(due);
        }
        let late = now - due;
        let missed = match self.every {
            Some(every) if self.in_time => late > LATEST.min(every),
            Some(_) => late > Duration::ZERO,
            None => false,
        };
        self.past = number;
        self.in_time = false;
        if missed && self.missed == Missed::Skip {
            ScheduleAction::Skip(number)
        } else {
            ScheduleAction::Dose(number)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ms(milliseconds: u64) -> Duration {
        Duration::from_millis(milliseconds)
    }

    fn every_second(count: u64, missed: Missed) -> Schedule {
        Schedule::new(count, Some(1.0), missed).unwrap()
    }

    #[test]
    fn doses_are_due_from_start_to_start_and_lateness_does_not_add_up() {
        let mut schedule = every_second(3, Missed::Skip);
        assert_eq!(schedule.next(ms(1)), ScheduleAction::Dose(1));
        assert_eq!(schedule.next(ms(900)), ScheduleAction::Wait(ms(1000)));
        assert_eq!(schedule.next(ms(1040)), ScheduleAction::Dose(2), "woken a little late is not missed");
        assert_eq!(schedule.next(ms(1041)), ScheduleAction::Wait(ms(2000)));
        assert_eq!(schedule.next(ms(2000)), ScheduleAction::Dose(3));
        assert_eq!(schedule.next(ms(2001)), ScheduleAction::Done);
        assert_eq!(schedule.next(ms(9000)), ScheduleAction::Done);
    }

    #[test]
    fn a_dose_that_came_due_while_the_one_before_ran_is_skipped_or_made_at_once() {
        let mut skips = every_second(5, Missed::Skip);
        assert_eq!(skips.next(ms(0)), ScheduleAction::Dose(1));
        let told: Vec<ScheduleAction> = (0..3).map(|_| skips.next(ms(2001))).collect();
        assert_eq!(told, [ScheduleAction::Skip(2), ScheduleAction::Skip(3), ScheduleAction::Wait(ms(3000))]);
        assert_eq!(skips.next(ms(3000)), ScheduleAction::Dose(4));
        assert_eq!(skips.next(ms(4000)), ScheduleAction::Dose(5), "due at this moment is not missed");

        let mut catches_up = every_second(5, Missed::Now);
        assert_eq!(catches_up.next(ms(0)), ScheduleAction::Dose(1));
        assert_eq!(catches_up.next(ms(2500)), ScheduleAction::Dose(2));
        assert_eq!(catches_up.next(ms(2600)), ScheduleAction::Dose(3));
        assert_eq!(catches_up.next(ms(2700)), ScheduleAction::Wait(ms(3000)), "back on its times");
    }

    #[test]
    fn a_dose_slept_through_is_missed() {
        for (missed, told) in
            [(Missed::Skip, ScheduleAction::Skip(2)), (Missed::Now, ScheduleAction::Dose(2))]
        {
            let mut schedule = every_second(9, missed);
            assert_eq!(schedule.next(ms(0)), ScheduleAction::Dose(1));
            assert_eq!(schedule.next(ms(1)), ScheduleAction::Wait(ms(1000)));
            assert_eq!(schedule.next(ms(2500)), told);
        }
    }

    #[test]
    fn without_an_interval_one_follows_the_other() {
        let mut schedule = Schedule::new(2, None, Missed::Skip).unwrap();
        assert_eq!(schedule.next(ms(5)), ScheduleAction::Dose(1));
        assert_eq!(schedule.next(ms(500_000)), ScheduleAction::Dose(2));
        assert_eq!(schedule.next(ms(500_000)), ScheduleAction::Done);
    }

    #[test]
    fn what_cannot_be_kept_is_refused_and_the_longest_batch_has_a_last_time() {
        assert_eq!(DOSES_ALLOWED.to_string(), format!("1 to {MAX_DOSES}"));
        assert_eq!(EVERY_ALLOWED.to_string(), format!("{} to {}", EVERY_S[0], EVERY_S[1]));
        for count in [0, u64::from(MAX_DOSES) + 1] {
            let error = Schedule::new(count, None, Missed::Skip).unwrap_err().to_string();
            assert!(error.contains("number of doses") && error.contains("1 to 1000000"), "{error}");
        }
        for every_s in [0.0, -1.0, 1e-9, 1e300, f64::NAN, f64::INFINITY] {
            assert!(Schedule::new(1, Some(every_s), Missed::Skip).is_err(), "{every_s}");
        }
        let longest = Schedule::new(MAX_DOSES.into(), Some(366.0 * 86_400.0), Missed::Skip).unwrap();
        assert_eq!(longest.due(MAX_DOSES.into()).as_secs(), 999_999 * 366 * 86_400);
    }
}
