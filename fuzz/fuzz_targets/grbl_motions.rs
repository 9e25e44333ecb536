//! Fuzzes the grbl drive in motion: whatever a board answers, a motion ends in bounded time, and the bounds of its
//! steps are in order.
#![no_main]

mod scripted_board;

use libfuzzer_sys::fuzz_target;

fuzz_target!(|script: &[u8]| scripted_board::run_scripted(script));
