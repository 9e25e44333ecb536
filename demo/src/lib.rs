//! The planner and the model in a browser: one dose, from what a person sets to the curves of the page.
//!
//! [`Demo`] is all of it. `exports` gives it to the page as plain functions over one memory; `page.html`, `page.css`
//! and four files of JavaScript stand beside this crate, and `build.py` makes one file of them.
#![cfg_attr(target_arch = "wasm32", no_std)]

mod demo;
mod errors;
#[cfg(target_arch = "wasm32")]
mod exports;
mod facts;
mod refusal;
mod settings;
mod trace;

pub use demo::{Demo, STEPS_AT_ONCE};
pub use errors::ANGLES;
pub use facts::FACTS;
pub use settings::SETTINGS;
pub use trace::{COLUMNS, ROWS};
