//! Transcendental and rounding functions, angles, polynomials and the metrics of a fit.
//!
//! The functions come from `libm` on every target, so a server, a microcontroller and Python compute the same
//! bits.

mod angle;
pub(crate) mod hermite;
pub mod metrics;
pub mod polynomial;

pub use angle::{TURN_RAD, degrees, rad_s, radians, rpm, wrap};
pub use libm::{acos, asin, atan2, ceil, cos, exp, floor, log, log10, pow, round, sin, sqrt};
