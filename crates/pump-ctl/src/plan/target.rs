//! From a volume to the whole number of steps that comes nearest.

use pump_model::Pump;
use pump_model::math::floor;

use super::PlanError;
use super::request::Request;

/// Most steps of a dose: eight hours at 36,000 a second.
const MAX_STEPS: f64 = 1e9;

/// Steps and what they deliver.
pub(super) struct Target {
    /// Negative in reverse.
    pub(super) steps: i64,
    /// V_out of the end angle less that of the start, mL.
    pub(super) planned_ml: f64,
}

/// The number of steps from `start_rad` whose volume is nearest to what the request owes.
pub(super) fn nearest_steps(
    pump: &Pump,
    start_rad: f64,
    request: &Request,
    step_rad: f64,
) -> Result<Target, PlanError> {
    let curve = pump.outlet_curve();
    let start_ml = curve.volume_ml(start_rad);
    let delivered = |steps: f64| curve.volume_ml(start_rad + steps * step_rad) - start_ml;
    let owed_ml = request.owed_ml();
    let ideal_rad = curve.angle_rad(start_ml + owed_ml) - start_rad;
    let below = floor(ideal_rad / step_rad);
    let (low_ml, high_ml) = (delivered(below), delivered(below + 1.0));
    let (steps, planned_ml) =
        if owed_ml - low_ml <= high_ml - owed_ml { (below, low_ml) } else { (below + 1.0, high_ml) };
    if steps == 0.0 {
        let first = if owed_ml < 0.0 { -1.0 } else { 1.0 };
        return Err(PlanError::LessThanHalfAStep {
            requested_ml: request.volume_ml,
            carry_in_ml: request.carry_in_ml,
            smallest_ml: 0.5 * delivered(first) - request.carry_in_ml,
        });
    }
    if steps.abs() > MAX_STEPS {
        return Err(PlanError::TooManySteps { steps: steps.abs() });
    }
    Ok(Target { steps: steps as i64, planned_ml })
}
