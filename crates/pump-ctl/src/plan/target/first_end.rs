//! The end of a dose on a head whose flow reverses.
//!
//! The functions are cold and stay out of line: most heads never need them, and copies would take flash.

use libm::{ceil, floor};
use pump_model::Pump;
use pump_model::units::TURN_RAD;

use super::delivered::delivered;
use crate::plan::words::{Phase, PlanError, Turned};

/// Largest number of steps of a dose. They take eight hours at 36,000 a second.
pub const MAX_STEPS: f64 = 1e9;

/// Pitches on either side of the mean line in which the turn with the smallest deviation is sought. The volume of a
/// turn departs from the mean line by as much where the flow takes back eight times what a pitch delivers.
const PITCHES: f64 = 8.0;

/// Number of parts that a search keeps. Each is half of the one before, and a turn has less than 2^32 steps.
const PARTS: usize = 40;

/// Returns half of the mean volume of a step, mL.
fn half_step_ml(pump: &Pump, step_rad: f64) -> f64 {
    0.5 * pump.revolution_ml() * step_rad / TURN_RAD
}

/// Finds the number of steps from a known angle, and their volume, mL. No steps stand for a volume less than half a
/// step.
///
/// The dose ends at the first angle at which it has delivered the volume. The flow is positive there, so nothing that
/// was delivered is taken back. It also ends at a local maximum that falls short by less than half of the mean step.
#[cold]
#[inline(never)]
pub(in crate::plan) fn first(pump: &Pump, start: Phase, owed_ml: f64, step_rad: f64) -> (f64, f64) {
    let (half_ml, start_rad) = (half_step_ml(pump, step_rad), start.angle_rad);
    if owed_ml.abs() <= half_ml {
        return (0.0, 0.0);
    }
    let direction = if owed_ml < 0.0 { -1.0 } else { 1.0 };
    let of_steps = |steps: f64| (direction * steps, delivered(pump, start, direction * steps, step_rad).0);
    let off_ml = |(_, ml): &(f64, f64)| (owed_ml - ml).abs();
    for reach in pump.outlet_curve().reaches(start_rad, owed_ml, half_ml) {
        let below = floor(direction * (reach.angle_rad - start_rad) / step_rad).max(0.0);
        let [fewer, more] = [below, below + 1.0].map(of_steps);
        let end = if off_ml(&fewer) <= off_ml(&more) { fewer } else { more };
        if end.0 == 0.0 {
            if more.1 * direction > 0.0 && !reach.is_short {
                return end;
            }
            // The flow turns back within the first step, which passes over this angle.
            continue;
        }
        if !reach.is_short || off_ml(&end) <= half_ml {
            return end;
        }
    }
    // The volume is farther away than a turn reaches.
    (direction * f64::INFINITY, owed_ml)
}

/// Finds the number of steps after a turn from an angle that is not known exactly, whose largest deviation from
/// `sum_ml` is smallest. Of equals it is the one with fewest steps.
///
/// Smallest and largest volume need not grow with the turn. So the search halves a stretch of turns, and leaves out
/// the parts in which no turn can be better: a step more changes both by no more than the largest flow times the step
/// (Piyavskii, USSR Comput. Math. Math. Phys. 12, 1972).
#[cold]
#[inline(never)]
pub(super) fn minimax(pump: &Pump, turned: Turned, owed_ml: f64, step_rad: f64) -> Result<f64, PlanError> {
    let curve = pump.outlet_curve();
    let sum_ml = turned.middle_ml(pump) + owed_ml;
    let slope_ml_rad = curve.pitch_ml() / curve.pitch_rad();
    // A volume departs from the mean line by what the flow takes back, and by a pitch.
    let (low_ml, high_ml) = curve.volume_range_ml(0.0, curve.pitch_rad());
    let spread_rad = (2.0 * (high_ml - low_ml) / slope_ml_rad).min(PITCHES * curve.pitch_rad());
    let half_rad = spread_rad + curve.pitch_rad() + (turned.most_rad - turned.least_rad) + step_rad;
    let middle_rad = sum_ml / slope_ml_rad - 0.5 * (turned.least_rad + turned.most_rad);
    let (low, high) = (floor((middle_rad - half_rad) / step_rad), ceil((middle_rad + half_rad) / step_rad));
    let fewest = if low * high > 0.0 { low.abs().min(high.abs()) } else { 0.0 };
    // A step more than the largest dose changes nothing.
    if fewest > MAX_STEPS || high - low > MAX_STEPS {
        return Err(PlanError::TooManySteps { steps: fewest.max(high - low) });
    }
    let off_ml = |steps: f64| off_ml(pump, turned.by(steps * step_rad, steps * step_rad), sum_ml);
    let steepest_ml = curve.largest_flow_ml_rad() * step_rad;
    // Whole pitches are a good start.
    let near = floor(floor(owed_ml / curve.pitch_ml() + 0.5) * curve.pitch_rad() / step_rad + 0.5);
    let mut best = (near, off_ml(near));
    let mut note = |steps: f64, off_ml: f64| {
        if off_ml < best.1 || (off_ml == best.1 && steps.abs() < best.0.abs()) {
            best = (steps, off_ml);
        }
        best.1
    };
    let mut parts = [(low, off_ml(low), high, off_ml(high)); PARTS];
    note(low, parts[0].1);
    note(high, parts[0].3);
    let mut count = 1_usize;
    while let Some(part) = count.checked_sub(1).and_then(|last| parts.get(last)) {
        let (low, low_ml, high, high_ml) = *part;
        count -= 1;
        let least_ml = 0.5 * (low_ml + high_ml - steepest_ml * (high - low));
        let middle = floor(0.5 * (low + high));
        let middle_ml = off_ml(middle);
        if high - low <= 1.0 || least_ml > note(middle, middle_ml) {
            continue;
        }
        for half in [(middle, middle_ml, high, high_ml), (low, low_ml, middle, middle_ml)] {
            if let Some(place) = parts.get_mut(count) {
                *place = half;
                count += 1;
            }
        }
    }
    Ok(best.0)
}

/// Returns the largest deviation of a turn's volumes from `sum_ml`, mL.
#[cold]
#[inline(never)]
fn off_ml(pump: &Pump, turned: Turned, sum_ml: f64) -> f64 {
    let (least_ml, most_ml) = turned.range_ml(pump);
    (sum_ml - least_ml).max(most_ml - sum_ml)
}

/// Returns the smallest volume that is more than no steps, mL. It has the sign of `direction`.
#[cold]
#[inline(never)]
pub(super) fn smallest_ml(pump: &Pump, turned: Turned, start: Phase, direction: f64, step_rad: f64) -> f64 {
    let aimed = turned.aimed();
    if aimed.is_exact() {
        let first_ml = direction * delivered(pump, start.aimed(), direction, step_rad).0;
        return direction * half_step_ml(pump, step_rad).max(0.5 * first_ml);
    }
    // A pitch delivers its volume from every angle. Between, a larger volume never has fewer steps than none.
    let (mut none_ml, mut some_ml) = (0.0, pump.outlet_curve().pitch_ml());
    for _ in 0..40 {
        let middle_ml = 0.5 * (none_ml + some_ml);
        match minimax(pump, aimed, direction * middle_ml, step_rad) {
            Ok(0.0) => none_ml = middle_ml,
            _ => some_ml = middle_ml,
        }
    }
    direction * some_ml
}
