//! The rate of a node's timer.

use core::num::NonZeroU32;

use pump_ctl::step::TickRate;

/// Returns the rate of a timer, which must not stand.
pub(crate) fn tick_rate(tick_hz: u32) -> TickRate {
    TickRate::from_hz(tick_hz).unwrap_or(TickRate::new(NonZeroU32::MIN))
}
