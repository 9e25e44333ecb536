//! The ripple of a dose's flow, and how sure it is.

mod errors;
mod ripple;

pub use ripple::{RippleAt, RippleReport};
pub(crate) use ripple::{SureRipples, sure_ripples};
