//! Angles, speeds of rotation, and their units.
//!
//! ```
//! use pump_model::units::{TURN_RAD, degrees, rad_s, wrap};
//! assert!((degrees(wrap(-0.25 * TURN_RAD, TURN_RAD)) - 270.0).abs() < 1e-12);
//! assert!((rad_s(60.0) - TURN_RAD).abs() < 1e-12);
//! ```

use libm::floor;

/// A full turn, rad.
pub const TURN_RAD: f64 = 2.0 * core::f64::consts::PI;

/// Returns the angle in `[0, period)` that equals `angle` up to whole periods. `period` must be positive.
pub fn wrap(angle: f64, period: f64) -> f64 {
    let wrapped = angle - period * floor(angle / period);
    // floor(-tiny / period) is -1, and period - tiny rounds to period.
    if wrapped >= period || wrapped < 0.0 { 0.0 } else { wrapped }
}

/// Converts an angle from degrees to radians.
pub fn radians(degrees: f64) -> f64 {
    degrees * (core::f64::consts::PI / 180.0)
}

/// Converts an angle from radians to degrees.
pub fn degrees(radians: f64) -> f64 {
    radians * (180.0 / core::f64::consts::PI)
}

/// Converts a speed from rad/s to r/min.
pub fn rpm(rad_s: f64) -> f64 {
    rad_s * (60.0 / TURN_RAD)
}

/// Converts a speed from r/min to rad/s.
pub fn rad_s(rpm: f64) -> f64 {
    rpm * (TURN_RAD / 60.0)
}
