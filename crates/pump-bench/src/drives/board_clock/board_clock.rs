//! The clock of a board.

use std::collections::VecDeque;
use std::time::Duration;

use super::error::ClockError;
use super::region::{Condition, Region};
use super::sample::Reading;

/// Most readings that are kept. A reading a second makes a minute, over which a clock's drift hardly changes.
const KEPT_MOST: usize = 64;

/// Room that each condition is given for the rounding of f64, s.
const ROUNDING_S: f64 = 1e-10;

/// Bounds of what a clock may do beside the other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::drives) struct ClockBounds {
    /// Most by which its rate deviates from the nominal one, relatively.
    pub(in crate::drives) drift: f64,
    /// Most by which this deviation changes in a second.
    pub(in crate::drives) wander_per_s: f64,
}

impl Default for ClockBounds {
    /// Returns the bounds of a board without a crystal: the internal oscillator of an STM32 is within 1 % (STM32F103
    /// data sheet, DocID13587, HSI), a ceramic resonator within 0.5 %, a crystal within 100 ppm.
    ///
    /// The change of 1 ppm in a second is that of a crystal that warms up, and of a computer's clock that NTP leads:
    /// 500 ppm at most, approached over many minutes (RFC 5905, section 11.3).
    fn default() -> Self {
        Self { drift: 0.01, wander_per_s: 1e-6 }
    }
}

/// Value with the distance within which the true one is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::drives) struct Within<T> {
    pub(in crate::drives) value: T,
    pub(in crate::drives) within: f64,
}

/// Clock of a board.
///
/// Each reading says that the clock stood at its ticks between two times. The offsets and drifts for which this holds
/// of all readings are a convex region, and the clock at any time is between the least and the most over its corners.
/// So the bounds hold whatever the delays of question and answer are, equal or not.
///
/// A drift that changes loosens what an old reading says: by half the change in a second, times the square of its age.
#[derive(Debug, Clone)]
pub(in crate::drives) struct BoardClock {
    frequency_hz: f64,
    bounds: ClockBounds,
    /// Readings, the oldest first. There is one at least.
    readings: VecDeque<Reading<u64>>,
    /// Offsets and drifts that the clock may have.
    region: Region,
    /// Time of the region's offsets.
    at: Duration,
    /// Ticks from which the region's offsets count.
    ticks: u64,
}

impl BoardClock {
    /// Begins with a first reading, whose ticks the board gave in full: those of its message `uptime`, which are
    /// `high` · 2^32 + `clock`. The frequency is the board's constant CLOCK_FREQ.
    pub(in crate::drives) fn new(
        frequency_hz: u32,
        bounds: ClockBounds,
        reading: Reading<u64>,
    ) -> Result<Self, ClockError> {
        let took = took_s(reading.from, reading.to)?;
        let frequency_hz = f64::from(frequency_hz.max(1));
        let most = took * (1.0 + bounds.drift) + 1.0 / frequency_hz + ROUNDING_S;
        let region = Region::new(-ROUNDING_S, most, bounds.drift);
        let (readings, at, ticks) = (VecDeque::from([reading]), reading.to, reading.ticks);
        Ok(Self { frequency_hz, bounds, readings, region, at, ticks })
    }

    /// Takes a reading of the low 32 bits of the clock, and returns the whole clock of that reading.
    ///
    /// After an error the clock is as it was before.
    pub(in crate::drives) fn take(&mut self, reading: Reading) -> Result<u64, ClockError> {
        took_s(reading.from, reading.to)?;
        let ticks = self.widen(reading.ticks, reading.to)?;
        let reading = Reading { from: reading.from, to: reading.to, ticks };
        let kept = self.readings.iter().copied();
        let Some(region) = self.region_of(kept.chain([reading]), reading) else {
            return Err(self.jump(reading));
        };
        (self.region, self.at, self.ticks) = (region, reading.to, ticks);
        self.readings.push_back(reading);
        if self.readings.len() > KEPT_MOST {
            self.forget_one();
        }
        Ok(ticks)
    }

    /// Returns the clock at a time, in ticks from [`Self::ticks`], and how far it may be wrong.
    fn offset(&self, time: Duration) -> Within<f64> {
        let after_s = seconds(self.at, time);
        let (least, most) = self.region.range(|point| after_s + point.offset + point.drift * after_s);
        let half = (most - least) / 2.0 + self.loosening_s(after_s);
        // A tick is read as the last whole one.
        let within = half * self.frequency_hz + 1.0;
        Within { value: (least + most) / 2.0 * self.frequency_hz, within }
    }

    /// Returns the clock at a time of the computer's clock, and the ticks by which it may be wrong.
    pub(in crate::drives) fn at(&self, time: Duration) -> Within<u64> {
        let Within { value, within } = self.offset(time);
        let value = self.ticks.saturating_add_signed(value.round() as i64);
        Within { value, within: within + 0.5 }
    }

    /// Returns the time of the computer's clock at which the board's stands at `ticks`, and the seconds by which it may
    /// be wrong. A time before the computer's clock began is its begin.
    #[cfg(test)]
    pub(in crate::drives) fn time_of(&self, ticks: u64) -> Within<Duration> {
        let elapsed_s = (i128::from(ticks) - i128::from(self.ticks)) as f64 / self.frequency_hz;
        let (least, most) = self.region.range(|point| (elapsed_s - point.offset) / (1.0 + point.drift));
        let after_s = (least + most) / 2.0;
        let within = (most - least) / 2.0
            + (self.loosening_s(elapsed_s) + 1.0 / self.frequency_hz) / (1.0 - self.bounds.drift);
        let after = Duration::try_from_secs_f64(after_s.abs()).unwrap_or(Duration::MAX);
        let value = if after_s < 0.0 { self.at.saturating_sub(after) } else { self.at.saturating_add(after) };
        Within { value, within }
    }

    /// Returns the time over which the clock was read: its drift is known the better, the longer that is.
    pub(in crate::drives) fn span(&self) -> Duration {
        self.readings.front().map_or(Duration::ZERO, |first| self.at.saturating_sub(first.to))
    }

    /// Returns the relative deviation of the clock's rate from its nominal one, and how far it may be wrong.
    #[cfg(test)]
    pub(in crate::drives) fn drift(&self) -> Within<f64> {
        let (least, most) = self.region.range(|point| point.drift);
        Within { value: (least + most) / 2.0, within: (most - least) / 2.0 }
    }

    /// Returns the whole clock whose low 32 bits the board told at about a time.
    pub(in crate::drives) fn widen(&self, low: u32, time: Duration) -> Result<u64, ClockError> {
        let Within { value, within } = self.at(time);
        // More than a quarter of a turn either way, and the next reading might be counted into another turn.
        if within > f64::from(1_u32 << 30) {
            let (ago_s, within_s) = (seconds(self.at, time), within / self.frequency_hz);
            return Err(ClockError::Stale { ago_s, within_s });
        }
        let ahead = low.wrapping_sub(value as u32).cast_signed();
        Ok(value.saturating_add_signed(i64::from(ahead)))
    }

    /// Returns the most by which a clock whose drift changes is elsewhere after or before some seconds.
    fn loosening_s(&self, seconds: f64) -> f64 {
        self.bounds.wander_per_s * seconds * seconds / 2.0
    }

    /// Returns the region of these readings, with offsets at the time and from the ticks of `reference`. `None` if no
    /// clock of these bounds has them all.
    fn region_of(
        &self,
        readings: impl Iterator<Item = Reading<u64>>,
        reference: Reading<u64>,
    ) -> Option<Region> {
        let took_s = seconds(reference.from, reference.to);
        let most = took_s * (1.0 + self.bounds.drift) + self.loosening_s(took_s) + 1.0 / self.frequency_hz;
        let mut region = Region::new(-2.0 * ROUNDING_S, most + 2.0 * ROUNDING_S, self.bounds.drift);
        for reading in readings {
            for condition in self.conditions(reading, reference) {
                region = region.cut(condition)?;
            }
        }
        Some(region)
    }

    /// Returns the conditions that a reading makes on the clock: it had reached the ticks when the answer came, and had
    /// not passed them when the question was sent.
    fn conditions(&self, reading: Reading<u64>, reference: Reading<u64>) -> [Condition; 2] {
        let elapsed_s = (i128::from(reading.ticks) - i128::from(reference.ticks)) as f64 / self.frequency_hz;
        let (to, from) = (seconds(reference.to, reading.to), seconds(reference.to, reading.from));
        let room = |lever| self.loosening_s(lever) + ROUNDING_S;
        let tick_s = 1.0 / self.frequency_hz;
        [
            Condition { sign: -1.0, lever: to, most: to - elapsed_s + room(to) },
            Condition { sign: 1.0, lever: from, most: elapsed_s + tick_s - from + room(from) },
        ]
    }

    /// Forgets the oldest reading that says no more than others do, or the oldest of all.
    fn forget_one(&mut self) {
        let reference = Reading { from: self.at, to: self.at, ticks: self.ticks };
        let is_idle = |reading: &Reading<u64>| {
            self.conditions(*reading, reference).iter().all(|condition| {
                let (least, _) = self.region.range(|point| condition.room(point));
                least > 10.0 * ROUNDING_S
            })
        };
        let idle = self.readings.iter().position(is_idle).unwrap_or(0);
        self.readings.remove(idle);
    }

    /// Returns the error of a reading that no clock of these bounds has.
    fn jump(&self, reading: Reading<u64>) -> ClockError {
        let (from, to) = (self.offset(reading.from), self.offset(reading.to));
        let told = (i128::from(reading.ticks) - i128::from(self.ticks)) as f64;
        let (least, most) = (from.value - from.within, to.value + to.within);
        let by = if told < least { told - least } else { (told - most).max(0.0) };
        let ms = 1000.0 / self.frequency_hz;
        ClockError::Jump { by_ms: by * ms, within_ms: to.within * ms }
    }
}

/// Returns the seconds from one time to another. They are negative if the other is the earlier.
fn seconds(from: Duration, to: Duration) -> f64 {
    match to.checked_sub(from) {
        Some(after) => after.as_secs_f64(),
        None => -from.saturating_sub(to).as_secs_f64(),
    }
}

/// Returns the time that a reading took.
fn took_s(from: Duration, to: Duration) -> Result<f64, ClockError> {
    let took_s = seconds(from, to);
    if took_s < 0.0 { Err(ClockError::Order { took_s }) } else { Ok(took_s) }
}
