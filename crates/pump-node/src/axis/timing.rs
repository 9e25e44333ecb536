//! Times of a driver in ticks, and rates of steps.

use core::num::NonZeroU32;

use pump_ctl::step::TickRate;

/// Returns the rate of a timer, which must not stand.
pub(crate) fn tick_rate(tick_hz: u32) -> TickRate {
    TickRate::from_hz(tick_hz).unwrap_or(TickRate::new(NonZeroU32::MIN))
}

/// Returns `ns` in whole ticks, rounded up.
pub(crate) fn ns_in_ticks(ns: u32, tick_hz: u32) -> u64 {
    (u64::from(ns) * u64::from(tick_hz)).div_ceil(1_000_000_000)
}

/// Returns the rate of steps that are `interval` ticks apart, Hz, rounded up.
pub(crate) fn rate_hz(interval: u32, tick_hz: u32) -> u32 {
    tick_hz.div_ceil(interval.max(1))
}
