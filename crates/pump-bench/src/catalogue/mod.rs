//! Pumps without a pump file of the user's: built-in pumps, and pumps made from a drawing.

mod bought_pump;
mod built_in;
mod catalogued_pump;
mod copied_pump;
mod drawn_pump;
mod microsteps;
mod overlap;
mod remarks;
mod roller_runs;
mod stated_motor;
mod suction;
mod tube_rating;
mod unusual;

pub use bought_pump::BoughtPump;
pub use built_in::{BUILT_IN, built_in, pump_named};
pub use catalogued_pump::CataloguedPump;
pub(crate) use copied_pump::{as_a_copy, with_own_uncertainty};
pub use drawn_pump::DrawnPump;
pub(crate) use drawn_pump::is_of_drawing;
pub(crate) use microsteps::{DECIMAL, POWERS};
pub use overlap::overlap_warning;
pub use roller_runs::{Fall, RollerRuns};
pub use stated_motor::{MotorSteps, StatedMotor};
pub(crate) use suction::{SUCKS, beyond_known_kpa, suction_warning};
pub(crate) use unusual::doubtful;
pub use unusual::{unusual, unusual_full_steps, unusual_microsteps};
