//! Times in ticks and rates of steps, as both ends compute them: a host refuses a plan for the reason for which the
//! node would.

/// Returns `ns` in whole ticks of a timer of this rate, Hz, rounded up.
pub const fn ns_in_ticks(ns: u32, tick_hz: u32) -> u64 {
    (ns as u64 * tick_hz as u64).div_ceil(1_000_000_000)
}

/// Returns the rate of steps that are `interval` ticks apart, Hz, rounded up. The node adds these rates up.
///
/// ```
/// use pump_link::timing::rate_hz;
///
/// assert_eq!(rate_hz(16, 1_000_000), 62_500);
/// assert_eq!(rate_hz(15, 1_000_000), 66_667);
/// ```
pub const fn rate_hz(interval: u32, tick_hz: u32) -> u32 {
    tick_hz.div_ceil(if interval == 0 { 1 } else { interval })
}
