//! The swing of the pressures of a smooth flow beside that at constant speed. The demo in the browser compiles this
//! file too, so it needs neither std nor this crate.

use pump_ctl::plan::{Cruise, Doser, Limits, Motor, Plan, PlanError, Prediction, Request};
use pump_model::{Extremes, Pump};

/// Swing of the inlet pressure over that at constant speed from which on a smooth flow is warned of.
const WIDER: f64 = 1.1;

/// Returns the prediction of the planned volume at constant speed, within the limits of the motor alone.
///
/// # Errors
///
/// [`PlanError`] of a dose that cannot be made at that speed.
pub(super) fn at_constant_speed(model: &Pump, plan: &Plan, motor: Motor) -> Result<Prediction, PlanError> {
    let cruise = Cruise::Speed { rad_s: plan.profile().cruise_rad_s() };
    let request = Request::new(plan.planned_ml(), cruise).with_ramps(plan.ramps());
    Doser::new(model, Limits::new(motor))?.plan(plan.start(), &request)?.predict(model)
}

/// Returns true if a pressure swings notably more than at constant speed.
pub(super) fn is_wider(smooth: Extremes, even: Extremes) -> bool {
    let swing_kpa = |range: Extremes| range.max_kpa - range.min_kpa;
    swing_kpa(smooth) > WIDER * swing_kpa(even)
}
