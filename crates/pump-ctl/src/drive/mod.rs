//! The drive of a motor: the executor of [`crate::step`] with pins or any other back end.
//!
//! [`StepMotor`] is the seam: every back end that can make one step can be driven. [`StepDir`] is the usual back
//! end, with step and direction pins of `embedded-hal`. [`Actuator`] joins a back end and an executor. Call
//! [`Actuator::on_timer`] from a timer's interrupt, or let [`Actuator::run`] make a whole move.

mod actuator;
mod blocking;
mod clock;
mod error;
mod pins;
mod step_motor;
mod timing;

pub use actuator::{Actuator, OnFault, Timer};
pub use clock::Clock;
pub use error::Fault;
pub use pins::{NoPin, Pin, PinFault, StepDir};
pub use step_motor::StepMotor;
pub use timing::Timing;
