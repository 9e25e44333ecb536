//! Quantities with their units, as people type them.

mod error;
mod kind;
mod quantity;
mod reading;

pub use error::QuantityError;
pub use kind::Kind;
pub use quantity::{
    Amount, Pressure, TubeSize, amount, angle_rad, flow_ml_s, length_mm, pressure, rate, speed_rad_s,
    temperature_degc, time_s, tube_size, volume_ml,
};
