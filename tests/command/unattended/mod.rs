//! Nights without anyone: limits, interrupted doses and failures that a program hears of.

mod limits;
#[cfg(unix)]
mod on_fail;
#[cfg(unix)]
mod unfinished;
