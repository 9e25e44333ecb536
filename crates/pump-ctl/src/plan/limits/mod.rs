//! The limits of a dose, and the margins of a plan to them.

mod bound;
mod brake;
mod limits;
mod margin;
mod margins;
mod motor;
mod pressure_limits;
mod reached;
mod torque;
mod torque_curve;
mod torque_reached;

pub(in crate::plan) use bound::Bound;
pub use limits::Limits;
pub use margin::Margin;
pub use margins::Margins;
pub use motor::Motor;
pub use pressure_limits::{Lowest, PressureLimits};
pub use torque::Torque;
pub use torque_curve::{TORQUE_POINTS, TorqueCurve};
