//! Pumps without a pump file of the user's: built-in pumps, and pumps made from a drawing.

mod bought_pump;
mod built_in;
mod catalogued_pump;
mod drawn_pump;
mod overlap;
mod remarks;
mod roller_runs;
mod stated_motor;

pub use bought_pump::BoughtPump;
pub use built_in::{BUILT_IN, built_in, pump_named};
pub use catalogued_pump::CataloguedPump;
pub use drawn_pump::DrawnPump;
pub use overlap::overlap_warning;
pub use roller_runs::{Fall, RollerRuns};
pub use stated_motor::{MotorSteps, StatedMotor};
