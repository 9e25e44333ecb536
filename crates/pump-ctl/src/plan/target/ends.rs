//! The ends of a dose at low flow.

use libm::{ceil, floor};
use pump_model::Pump;
use pump_model::units::degrees;

use super::delivered::{booked, delivered};
use super::ends_by_volume::EndsByVolume;
use super::low_flow::LowFlow;
use super::target::Target;
use crate::plan::words::{Phase, PlanError, Request, Turned};

/// A number of steps, and the smallest and the largest volume that they deliver, mL.
type LowFlowEnd = (f64, (f64, f64));

/// Finds the two ends at low flow nearest to `nearest_steps`, the first with no more steps, the second with
/// no fewer.
///
/// `nearest_steps` itself counts as both. Both ends lie in the direction of `owed_ml`, and neither has zero
/// steps. A pump whose flow is never low is refused. An angle that is not known well enough at the end is
/// refused too.
///
/// Where the flow reverses, the ends are the nearest by their volume.
pub(in crate::plan) fn ends(
    pump: &Pump,
    start: Phase,
    owed_ml: f64,
    nearest_steps: f64,
    step_rad: f64,
) -> Result<[Option<LowFlowEnd>; 2], PlanError> {
    let curve = pump.outlet_curve();
    if !start.is_known(curve.pitch_rad()) {
        let half_width_deg = degrees(start.half_width_rad);
        return Err(PlanError::LowFlowWithoutAngle { half_width_deg, widest_deg: 0.0 });
    }
    let low = LowFlow::new(pump, start.half_width_rad)?;
    let direction = if owed_ml < 0.0 { -1.0 } else { 1.0 };
    let nearest = direction * nearest_steps;
    let per_pitch = curve.pitch_rad() / step_rad;
    let revolution = f64::from(pump.geometry().rollers);
    let pitch = floor((start.angle_rad + nearest_steps * step_rad) / curve.pitch_rad());
    let (mut below, mut above) = (f64::NEG_INFINITY, f64::INFINITY);
    let mut by_volume = EndsByVolume::new(owed_ml.abs(), |steps: f64| {
        let (least_ml, most_ml) = delivered(pump, start.aimed(), direction * steps, step_rad);
        direction * 0.5 * (least_ml + most_ml)
    });
    // A coarse step may pass over a stretch. Over a revolution it meets every stretch that it ever meets.
    let mut away = -revolution - 1.0;
    while away <= revolution + 1.0 {
        for (begun_rad, ended_rad) in low.stretches() {
            // Steps from the start to the two ends of the stretch, in the direction of the dose.
            let offset = (pitch + away) * per_pitch - start.angle_rad / step_rad;
            let [a, b] = [begun_rad, ended_rad].map(|rad| direction * (offset + rad / step_rad));
            let (first, last) = (ceil(a.min(b)).max(1.0), floor(a.max(b)));
            if first > last {
                continue;
            }
            if curve.reverses() {
                by_volume.look(first, last);
                continue;
            }
            if first <= nearest {
                below = below.max(last.min(nearest));
            }
            if last >= nearest {
                above = above.min(first.max(nearest));
            }
        }
        away += 1.0;
    }
    let end = |steps: f64| {
        let steps_signed = direction * steps;
        (steps_signed, delivered(pump, start, steps_signed, step_rad))
    };
    if curve.reverses() {
        return Ok([by_volume.below, by_volume.above].map(|found| found.map(|(steps, _)| end(steps))));
    }
    Ok([below, above].map(|steps| steps.is_finite().then(|| end(steps))))
}

/// Returns the better of the two ends at low flow around `nearest_steps`. Its worst deviation from the volume
/// requested plus carried is the smaller one. From a stated angle it is the deviation from this very angle.
pub(super) fn at_low_flow(
    pump: &Pump,
    start: Phase,
    turned: Turned,
    request: &Request,
    nearest_steps: f64,
    step_rad: f64,
) -> Result<Target, PlanError> {
    let owed_ml = request.owed_ml();
    let ends = ends(pump, start, owed_ml, nearest_steps, step_rad)?;
    let off_ml = |(steps, _): &LowFlowEnd| {
        let (least_ml, most_ml) = delivered(pump, start.aimed(), *steps, step_rad);
        (owed_ml - least_ml).abs().max((owed_ml - most_ml).abs())
    };
    let nearer = match ends.into() {
        (Some(below), Some(above)) => Some(if off_ml(&below) <= off_ml(&above) { below } else { above }),
        (below, above) => below.or(above),
    };
    let Some((steps, range_ml)) = nearer else {
        return Err(PlanError::LowFlowTooNarrow { step_deg: degrees(step_rad) });
    };
    let planned_ml = booked(pump, turned, steps, step_rad);
    if off_ml(&(steps, range_ml)) > owed_ml.abs() {
        let smallest_ml = planned_ml - request.carry_in_ml;
        return Err(PlanError::NoLowFlowEnd { requested_ml: request.volume_ml, smallest_ml });
    }
    Ok(Target { steps: steps as i64, planned_ml, range_ml })
}
