//! Transcendental and rounding functions, from `libm` on every target, so that a server, a microcontroller
//! and Python compute the same bits. Beside them angles, polynomials and the metrics of a fit.

mod angle;
pub(crate) mod hermite;
pub mod metrics;
pub mod polynomial;

pub use angle::{TURN_RAD, degrees, rad_s, radians, rpm, wrap};
pub use libm::{acos, asin, atan2, ceil, cos, exp, floor, log, log10, pow, round, sin, sqrt};
