//! The time in which the outlet's line comes to rest after the rollers stop at once.

use pump_model::{ExactRun, Leg, Port, Pump};

use super::error::SizingError;

/// Angles of a pitch at which the rollers are stopped.
const STOPS: u32 = 24;

/// Returns the time in s after which less than 1 µL is still to come, for the rollers that stop at the worst angle of
/// the steady state.
pub(super) fn settling_s(pump: &Pump, speed_rad_s: f64) -> Result<f64, SizingError> {
    let state = pump.periodic_state(Port::Outlet, speed_rad_s)?;
    let period_s = pump.pitch_rad() / speed_rad_s.abs();
    let mut worst_s = 0.0;
    for stop in 0..STOPS {
        let mut run = ExactRun::new(pump, Port::Outlet, [Leg::constant_speed(0.0, speed_rad_s)], state);
        run.at(period_s * f64::from(stop) / f64::from(STOPS));
        worst_s = f64::max(worst_s, run.settling_s()?);
    }
    Ok(worst_s)
}
