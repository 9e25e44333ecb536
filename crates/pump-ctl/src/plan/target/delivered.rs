//! The volume that a number of steps delivers.

use pump_model::Pump;

use crate::plan::words::{Phase, Turned};

/// Returns the smallest and the largest volume of `steps` from `start`, mL.
pub(in crate::plan) fn delivered(pump: &Pump, start: Phase, steps: f64, step_rad: f64) -> (f64, f64) {
    if start.half_width_rad == 0.0 {
        let curve = pump.outlet_curve();
        let volume_ml =
            curve.volume_ml(start.angle_rad + steps * step_rad) - curve.volume_ml(start.angle_rad);
        (volume_ml, volume_ml)
    } else {
        start.range_ml(pump, steps * step_rad)
    }
}

/// Returns the volume that `steps` add to the middle of the volumes of `turned`, mL.
pub(in crate::plan) fn booked(pump: &Pump, turned: Turned, steps: f64, step_rad: f64) -> f64 {
    let turn_rad = steps * step_rad;
    turned.by(turn_rad, turn_rad).middle_ml(pump) - turned.middle_ml(pump)
}
