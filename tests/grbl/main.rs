//! Claims about the grbl driver, on a simulated board at the end of a pseudo-terminal.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

#[path = "../../examples/simulated_grbl/board_words.rs"]
mod board_words;
mod boards;
mod confirmation;
mod connecting;
mod dosing;
mod exit_codes;
mod faults;
mod interference;
mod lines;
mod motions;
mod policies;
mod record;
mod replies;
mod rig;
mod runs;
mod searching;
mod sessions;
mod settings;
#[path = "../../examples/simulated_grbl/simulated/mod.rs"]
mod simulated;
mod talkative;
mod virtual_time;
