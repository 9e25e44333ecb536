//! The figures of a planned dose, in the order of the page.

use pump_ctl::plan::{Motor, Plan, PlanError};
use pump_model::Pump;
use pump_model::units::TURN_RAD;

/// Number of figures.
pub const FACTS: usize = 24;

/// Returns the figures of a dose of `volume_ml`. `engine.js` has their names in this order.
///
/// # Errors
/// Returns the [`PlanError`] of a line that never settles.
pub(crate) fn facts(
    pump: &Pump,
    motor: &Motor,
    volume_ml: f64,
    plan: &Plan,
) -> Result<[f64; FACTS], PlanError> {
    let pressures = plan.predict(pump)?;
    let ripples = plan.ripples(pump);
    let percent =
        |part: Option<pump_model::Ripple>| part.map_or(f64::NAN, |ripple| 100.0 * ripple.peak_to_peak);
    let start_rad = plan.start().angle_rad();
    let by_constant = steps_by_constant(pump, motor, volume_ml);
    let geometry = pump.geometry();
    Ok([
        plan.steps() as f64,
        plan.planned_ml(),
        plan.carry_ml(),
        plan.profile().duration_s(),
        pressures.settle_s,
        pressures.inlet.min_kpa,
        pressures.inlet.max_kpa,
        pressures.outlet.min_kpa,
        pressures.outlet.max_kpa,
        start_rad,
        plan.end_angle_rad(),
        by_constant,
        volume_of(pump, motor, start_rad, by_constant),
        pump.revolution_ml(),
        f64::from(geometry.rollers),
        plan.profile().peak_rad_s(),
        percent(ripples.outflow_before),
        percent(ripples.outflow_after),
        // Lengths are 0 where the head is known by its volume.
        geometry.backplate_radius_mm,
        geometry.tube_outer_radius_mm,
        geometry.roller_radius_mm,
        geometry.roller_offset_mm,
        geometry.contact_angle_rad,
        pump.roller_volume().engagement_rad(),
    ])
}

/// Returns the steps of a controller that knows the volume of a revolution alone.
pub(crate) fn steps_by_constant(pump: &Pump, motor: &Motor, volume_ml: f64) -> f64 {
    libm::floor(volume_ml / pump.revolution_ml() * motor.steps_per_rev + 0.5)
}

/// Returns the volume that `steps` deliver from an angle, mL.
pub(crate) fn volume_of(pump: &Pump, motor: &Motor, start_rad: f64, steps: f64) -> f64 {
    let curve = pump.outlet_curve();
    curve.volume_ml(start_rad + steps * (TURN_RAD / motor.steps_per_rev)) - curve.volume_ml(start_rad)
}
