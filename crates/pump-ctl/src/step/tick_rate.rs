//! The rate of the caller's timer.

use core::fmt;
use core::num::NonZeroU32;

/// The rate of the timer that makes the steps, ticks a second.
///
/// A brake and the segments of a plan are made for one timer and keep its rate. The executor refuses segments
/// whose rate is not that of its brake.
///
/// ```
/// use pump_ctl::step::TickRate;
///
/// const TICK_RATE: TickRate = TickRate::from_hz(1_000_000).unwrap();
/// assert_eq!(TICK_RATE.hz(), 1_000_000);
/// // A timer that stands makes no steps.
/// assert_eq!(TickRate::from_hz(0), None);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TickRate(NonZeroU32);

impl TickRate {
    /// Makes the rate of a timer.
    pub const fn new(hz: NonZeroU32) -> Self {
        Self(hz)
    }

    /// Makes the rate of a timer, or `None` of 0 ticks a second.
    pub const fn from_hz(hz: u32) -> Option<Self> {
        match NonZeroU32::new(hz) {
            Some(hz) => Some(Self(hz)),
            None => None,
        }
    }

    /// Returns the ticks in a second.
    pub const fn hz(self) -> u32 {
        self.0.get()
    }
}

impl From<NonZeroU32> for TickRate {
    fn from(hz: NonZeroU32) -> Self {
        Self(hz)
    }
}

impl fmt::Display for TickRate {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(to, "{} ticks a second", self.0)
    }
}

#[cfg(feature = "defmt")]
impl defmt::Format for TickRate {
    fn format(&self, to: defmt::Formatter<'_>) {
        defmt::write!(to, "{} ticks a second", self.hz());
    }
}
