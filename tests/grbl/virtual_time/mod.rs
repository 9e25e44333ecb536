//! Claims that need a clock which no busy machine disturbs, and time that a test does not take.

pub(crate) mod board;
mod counters;
mod pauses;
pub(crate) mod session;
