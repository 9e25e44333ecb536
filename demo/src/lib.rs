//! The planner and the model in a browser: one dose, from what a person sets to the curves of the page.
//!
//! [`Demo`] is all of it. `exports` gives it to the page as plain functions over one memory; `page.html`, `page.css`
//! and four files of JavaScript stand beside this crate, and `build.py` makes one file of them.
#![cfg_attr(target_arch = "wasm32", no_std)]

mod cautions;
mod demo;
mod errors;
#[cfg(target_arch = "wasm32")]
mod exports;
mod facts;
mod refusal;
mod settings;
mod trace;

// The command's own code, of files that need neither std nor their crate.
#[path = "../../crates/pump-bench/src/dosing/ripple/errors.rs"]
mod draws;
#[path = "../../crates/pump-bench/src/dosing/ripple/other_pump.rs"]
mod other_pump;
#[path = "../../crates/pump-bench/src/displacement/pulse_spread.rs"]
mod pulse_spread;
#[allow(dead_code, reason = "the demo has no budget of uncertainty")]
#[path = "../../crates/pump-bench/src/calibration/fit/phase/pulse_sureness.rs"]
mod pulse_sureness;
#[path = "../../crates/pump-bench/src/dosing/warnings/swing.rs"]
mod swing;

pub use cautions::CAUTIONS;
pub use demo::{Demo, STEPS_AT_ONCE};
pub use errors::ANGLES;
pub use facts::FACTS;
pub use settings::SETTINGS;
pub use trace::{COLUMNS, ROWS};
