//! Pumps that need no pump file of the user's: built-in ones, and those made from a drawing.

mod built_in;
mod drawn_pump;
mod roller_runs;

pub use built_in::{BUILT_IN, built_in, pump_named};
pub use drawn_pump::DrawnPump;
pub use roller_runs::{Fall, RollerRuns};
