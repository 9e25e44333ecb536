//! Turning a motor: the executor of [`crate::step`] with pins or any other back end.
//!
//! [`Motion`] is the seam: whatever can make one step can be driven. [`StepDir`] is the usual back end, step and
//! direction pins of `embedded-hal`. [`Actuator`] joins a back end and an executor; its [`Actuator::on_timer`] goes
//! into a timer's interrupt, or [`Actuator::run`] does a whole move and returns when it is over.

mod actuator;
mod blocking;
mod clock;
mod error;
mod motion;
mod pins;

pub use actuator::{Actuator, OnFault, Timer};
pub use clock::Clock;
pub use error::{Fault, StepFault};
pub use motion::Motion;
pub use pins::{NoPin, Pin, PinFault, StepDir, Timing};
