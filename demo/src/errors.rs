//! The error of a dose over the angle at which the rollers stand at its start.

use pump_ctl::plan::{Cruise, Doser, Limits, Phase, PlanError, Ramps, Request};
use pump_model::Pump;

use crate::facts::{steps_by_constant, volume_of};
use crate::settings::Settings;

/// Number of start angles over a pitch, both ends among them.
pub const ANGLES: usize = 181;

/// Errors over the start angle, in columns of [`ANGLES`]: the angle, rad; the error by one constant, mL; the error as
/// planned, mL, not a number where no dose so small is possible.
pub(crate) type Errors = [[f64; ANGLES]; 3];

/// Computes the errors of a dose from start angles over a pitch.
///
/// # Errors
/// Returns the [`PlanError`] of limits that are out of range.
pub(crate) fn errors(settings: &Settings, pump: &Pump, to: &mut Errors) -> Result<(), PlanError> {
    let (motor, volume_ml) = (settings.motor(), settings.volume_ml());
    let doser = Doser::new(pump, Limits::new(motor))?;
    // The steps of a dose do not depend on its speed, so the speed that is found soonest serves.
    let cruise = Cruise::Speed { rad_s: motor.max_speed_rad_s };
    let request = Request::new(volume_ml, cruise).with_ramps(Ramps::Fastest);
    let steps = steps_by_constant(pump, &motor, volume_ml);
    let [angles_rad, by_constant_ml, planned_ml] = to;
    for n in 0..ANGLES {
        let angle_rad = pump.pitch_rad() * n as f64 / (ANGLES - 1) as f64;
        angles_rad[n] = angle_rad;
        by_constant_ml[n] = volume_of(pump, &motor, angle_rad, steps) - volume_ml;
        planned_ml[n] =
            doser.plan(Phase::known(angle_rad), &request).map_or(f64::NAN, |plan| -plan.carry_ml());
    }
    Ok(())
}
