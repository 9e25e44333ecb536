//! Claims about racks: all is checked before anything moves, the pumps keep one timetable, and a stop of one stops all.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod gradients;
mod late;
mod refusals;
mod rig;
mod runs;
mod stops;
