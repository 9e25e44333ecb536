//! Quantities with their units, as people type them: `25mL`, `600 mL/min`, `100rpm`, `1.2bara`.
//!
//! Text is parsed once, at the edge. Inside there are numbers whose names carry the unit.

mod amount;
mod count;
mod error;
mod hose_size;
mod kind;
mod pressure;
mod quantity;
mod rate;
mod reading;
mod stated_angle;
mod stated_reading;
#[cfg(test)]
mod tests;
mod tube_size;

pub use amount::{Amount, amount, dose_amount};
pub use count::{FULL_STEPS_PER_REV, MICROSTEPS, ROLLERS, STEPS_PER_REV, count};
pub use error::QuantityError;
pub use hose_size::{HoseSize, hose_size};
pub use kind::Kind;
pub use pressure::{Pressure, pressure};
pub use quantity::{
    angle_rad, current_a, flow_ml_s, height_mm, instant_s, length_mm, life_ml, rotor_angle_rad, speed_rad_s,
    temperature_degc, time_s, volume_ml,
};
pub use rate::rate;
pub use stated_angle::{StatedAngle, stated_angle, tolerance_rad};
pub(crate) use stated_reading::last_digit;
pub use stated_reading::{StatedReading, stated_reading};
pub use tube_size::{TubeSize, tube_size};
