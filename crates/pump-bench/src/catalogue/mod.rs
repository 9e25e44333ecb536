//! Pumps without a pump file of the user's: built-in pumps, and pumps made from a drawing.

mod built_in;
mod drawn_pump;
mod roller_runs;
mod stated_motor;
mod unweighed;

pub use built_in::{BUILT_IN, built_in, pump_named};
pub use drawn_pump::DrawnPump;
pub use roller_runs::{Fall, RollerRuns};
pub use stated_motor::{MotorSteps, StatedMotor};
