//! The whole number of steps whose volume is nearest to a volume asked for.

use libm::{ceil, floor};
use pump_model::Pump;

use super::delivered::{booked, delivered};
use super::ends::at_low_flow;
use super::first_end::{self, MAX_STEPS};
use super::target::Target;
use crate::plan::words::{Finish, Phase, PlanError, Request, Turned};

/// Finds the number of steps from `start` whose volume is nearest to the volume requested plus carried.
///
/// From a stated angle ([`Phase::is_stated`]) the volume is that from this very angle. From an angle that is known
/// less well, each number of steps has a largest deviation over all angles at which the rollers may stand. The
/// result is the number for which it is smallest. Earlier doses since such an angle count: the deviation is that of
/// their sum with this dose.
///
/// Where the flow reverses, the dose ends at the first angle at which it has delivered the volume.
pub(in crate::plan) fn nearest_steps(
    pump: &Pump,
    start: Phase,
    request: &Request,
    step_rad: f64,
) -> Result<Target, PlanError> {
    let turned = request.turned.unwrap_or(Turned::at(start));
    let aimed = start.aimed();
    let (steps, known_ml) = if aimed.half_width_rad == 0.0 && turned.aimed().is_exact() {
        let (steps, volume_ml) = nearest(pump, aimed, request, step_rad);
        // Volumes after earlier doses are booked by the whole turn.
        (steps, (start == aimed && turned.is_exact()).then_some(volume_ml))
    } else {
        (minimax(pump, turned.aimed(), request, step_rad)?, None)
    };
    if steps == 0.0 {
        let (direction, farther): (f64, fn(f64, f64) -> f64) =
            if request.owed_ml() < 0.0 { (-1.0, f64::min) } else { (1.0, f64::max) };
        let (least_ml, most_ml) = delivered(pump, aimed, direction, step_rad);
        let least_ml = if pump.outlet_curve().reverses() {
            first_end::smallest_ml(pump, turned, start, direction, step_rad)
        } else {
            0.5 * farther(least_ml, most_ml)
        };
        return Err(PlanError::LessThanHalfAStep {
            requested_ml: request.volume_ml,
            carry_in_ml: request.carry_in_ml,
            smallest_ml: least_ml - request.carry_in_ml,
        });
    }
    if steps.abs() > MAX_STEPS {
        return Err(PlanError::TooManySteps { steps: steps.abs() });
    }
    match request.finish {
        Finish::Any => {
            let (planned_ml, range_ml) = match known_ml {
                Some(volume_ml) => (volume_ml, (volume_ml, volume_ml)),
                None => (booked(pump, turned, steps, step_rad), delivered(pump, start, steps, step_rad)),
            };
            Ok(Target { steps: steps as i64, planned_ml, range_ml })
        }
        Finish::LowFlow => at_low_flow(pump, start, turned, request, steps, step_rad),
    }
}

/// Finds the number of steps from a known angle, and their volume, mL. It is one of the two numbers beside the
/// ideal end angle.
fn nearest(pump: &Pump, start: Phase, request: &Request, step_rad: f64) -> (f64, f64) {
    let curve = pump.outlet_curve();
    let owed_ml = request.owed_ml();
    if curve.reverses() {
        return first_end::first(pump, start, owed_ml, step_rad);
    }
    let ideal_rad = curve.angle_rad(curve.volume_ml(start.angle_rad) + owed_ml) - start.angle_rad;
    let below = floor(ideal_rad / step_rad);
    let [(low_ml, _), (high_ml, _)] =
        [below, below + 1.0].map(|steps| delivered(pump, start, steps, step_rad));
    if owed_ml - low_ml <= high_ml - owed_ml { (below, low_ml) } else { (below + 1.0, high_ml) }
}

/// Finds the number of steps after a turn from an angle that is not known exactly.
///
/// Smallest and largest volume of the whole turn both grow with the turn. So the largest deviation is smallest
/// at the turn where both are equally far from the sum of the volumes. The result is the number of steps on
/// one side of that turn or the other.
fn minimax(pump: &Pump, turned: Turned, request: &Request, step_rad: f64) -> Result<f64, PlanError> {
    let curve = pump.outlet_curve();
    let owed_ml = request.owed_ml();
    if curve.reverses() {
        return first_end::minimax(pump, turned, owed_ml, step_rad);
    }
    let sum_ml = turned.middle_ml(pump) + owed_ml;
    // Whole pitches deliver an equal volume from every angle, so the turn lies between two of them.
    let pitches = floor(owed_ml / curve.pitch_ml());
    let mut below = floor(pitches * curve.pitch_rad() / step_rad) - 1.0;
    let mut above = ceil((pitches + 1.0) * curve.pitch_rad() / step_rad) + 1.0;
    let fewest = below.abs().min(above.abs());
    if fewest > MAX_STEPS {
        return Err(PlanError::TooManySteps { steps: fewest });
    }
    let after = |steps: f64| turned.by(steps * step_rad, steps * step_rad);
    while above - below > 1.0 {
        let steps = floor(0.5 * (below + above));
        if after(steps).middle_ml(pump) <= sum_ml {
            below = steps;
        } else {
            above = steps;
        }
    }
    let [low, high] = [below, above].map(|steps| after(steps).range_ml(pump));
    Ok(if sum_ml - low.0 <= high.1 - sum_ml { below } else { above })
}
