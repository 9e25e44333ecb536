//! From a volume to the whole number of steps that comes nearest.

use pump_model::Pump;
use pump_model::math::{ceil, floor};

use super::finish::at_low_flow;
use super::request::Request;
use super::{Finish, Phase, PlanError};

/// Most steps of a dose: eight hours at 36,000 a second.
const MAX_STEPS: f64 = 1e9;

/// Steps and what they deliver.
pub(super) struct Target {
    /// Negative in reverse.
    pub(super) steps: i64,
    /// V_out of the end angle less that of the start, mL; the middle of what it may be.
    pub(super) planned_ml: f64,
    /// Smallest and largest that it may be, mL.
    pub(super) range_ml: (f64, f64),
}

/// The number of steps from `start` whose volume is nearest to what the request owes: of an angle that is not known exactly,
/// the number whose largest deviation from any angle that it may be is smallest.
pub(super) fn nearest_steps(
    pump: &Pump,
    start: Phase,
    request: &Request,
    step_rad: f64,
) -> Result<Target, PlanError> {
    let known = start.half_width_rad == 0.0;
    let (steps, range_ml) = if known {
        nearest(pump, start, request, step_rad)
    } else {
        minimax(pump, start, request, step_rad)?
    };
    if steps == 0.0 {
        let (direction, farther): (f64, fn(f64, f64) -> f64) =
            if request.owed_ml() < 0.0 { (-1.0, f64::min) } else { (1.0, f64::max) };
        let (least_ml, most_ml) = delivered(pump, start, direction, step_rad);
        return Err(PlanError::LessThanHalfAStep {
            requested_ml: request.volume_ml,
            carry_in_ml: request.carry_in_ml,
            smallest_ml: 0.5 * farther(least_ml, most_ml) - request.carry_in_ml,
        });
    }
    if steps.abs() > MAX_STEPS {
        return Err(PlanError::TooManySteps { steps: steps.abs() });
    }
    match request.finish {
        Finish::Any => Ok(Target { steps: steps as i64, planned_ml: middle(range_ml), range_ml }),
        Finish::LowFlow => at_low_flow(pump, start, request, steps, step_rad),
    }
}

/// The middle of a range; where it is a single number, that number to the last bit.
pub(super) fn middle((least_ml, most_ml): (f64, f64)) -> f64 {
    least_ml + 0.5 * (most_ml - least_ml)
}

/// Smallest and largest volume of `steps` from `start`, mL.
pub(super) fn delivered(pump: &Pump, start: Phase, steps: f64, step_rad: f64) -> (f64, f64) {
    if start.half_width_rad == 0.0 {
        let curve = pump.outlet_curve();
        let volume_ml =
            curve.volume_ml(start.angle_rad + steps * step_rad) - curve.volume_ml(start.angle_rad);
        (volume_ml, volume_ml)
    } else {
        start.range_ml(pump, steps * step_rad)
    }
}

/// From a known angle: one of the two whole steps beside the angle at which the volume is there.
fn nearest(pump: &Pump, start: Phase, request: &Request, step_rad: f64) -> (f64, (f64, f64)) {
    let curve = pump.outlet_curve();
    let owed_ml = request.owed_ml();
    let ideal_rad = curve.angle_rad(curve.volume_ml(start.angle_rad) + owed_ml) - start.angle_rad;
    let below = floor(ideal_rad / step_rad);
    let [low, high] = [below, below + 1.0].map(|steps| delivered(pump, start, steps, step_rad));
    if owed_ml - low.0 <= high.0 - owed_ml { (below, low) } else { (below + 1.0, high) }
}

/// From anywhere that `start` may be. Smallest and largest volume both grow with the turn, so the largest deviation is
/// smallest where both are equally far from what is owed: on one side of that turn or the other.
fn minimax(
    pump: &Pump,
    start: Phase,
    request: &Request,
    step_rad: f64,
) -> Result<(f64, (f64, f64)), PlanError> {
    let curve = pump.outlet_curve();
    let owed_ml = request.owed_ml();
    // Whole pitches deliver the same from anywhere, so the turn lies between two of them.
    let pitches = floor(owed_ml / curve.pitch_ml());
    let mut below = floor(pitches * curve.pitch_rad() / step_rad) - 1.0;
    let mut above = ceil((pitches + 1.0) * curve.pitch_rad() / step_rad) + 1.0;
    let fewest = below.abs().min(above.abs());
    if fewest > MAX_STEPS {
        return Err(PlanError::TooManySteps { steps: fewest });
    }
    while above - below > 1.0 {
        let steps = floor(0.5 * (below + above));
        if middle(delivered(pump, start, steps, step_rad)) <= owed_ml {
            below = steps;
        } else {
            above = steps;
        }
    }
    let [low, high] = [below, above].map(|steps| delivered(pump, start, steps, step_rad));
    Ok(if owed_ml - low.0 <= high.1 - owed_ml { (below, low) } else { (above, high) })
}
