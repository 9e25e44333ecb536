//! Claims that need a clock which no busy machine disturbs, and time that a test does not take.

mod board;
mod counters;
mod pauses;
