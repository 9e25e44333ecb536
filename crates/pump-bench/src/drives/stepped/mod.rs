//! A motor that makes one step at a time: step and direction pins, or any other [`StepMotor`].
//!
//! [`StepMotor`]: pump_ctl::drive::StepMotor

mod clock;
mod lead;
mod pace;
mod stepped;
mod watched_motor;

#[cfg(any(feature = "node", feature = "klipper"))]
pub(super) use lead::Lead;
#[cfg(any(feature = "node", feature = "klipper"))]
pub(super) use pace::steps_from;

pub use clock::MonotonicClock;
pub use stepped::{Stepped, SteppedError};
