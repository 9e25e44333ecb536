//! Nights without anyone: limits, interrupted doses and failures that a program hears of.

#[cfg(unix)]
pub(crate) mod clock;
mod limits;
#[cfg(unix)]
mod on_fail;
#[cfg(unix)]
mod unfinished;
#[cfg(target_os = "linux")]
mod units;
