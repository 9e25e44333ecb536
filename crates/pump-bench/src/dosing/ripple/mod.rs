//! The ripple of a dose's flow, and how sure it is.

mod errors;
mod other_pump;
mod pulse_errors;
mod ripple;
mod unsure;

pub(crate) use pulse_errors::PulseErrors;
pub use ripple::{RippleAt, RippleReport};
pub(crate) use ripple::{SureRipples, sure_ripples};
pub(super) use unsure::unsure_smooth;
