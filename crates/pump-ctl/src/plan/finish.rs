//! Where in a pitch a dose may end.

use pump_model::math::{ceil, degrees, floor};
use pump_model::{FlowCurve, Pump};

use super::target::{Target, delivered, middle};
use super::{Phase, Plan, PlanError, Request};

/// Where in a pitch a dose may end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Finish {
    /// Anywhere.
    #[default]
    Any,
    /// Where a step delivers little: q_out is at most half of what it is between pulses, [`Pump::nominal_ml_rad`]. There a
    /// stop leaves least to drip, and steps are at most half as coarse.
    LowFlow,
}

/// Part of the flow between pulses that counts as low. Half is reached within a pulse of every pump whose rollers take
/// more than that at once, and is far from where a pulse begins and ends, so that the end's place in the pitch is no
/// matter of rounding.
const LOW: f64 = 0.5;

/// Angles of a pitch are looked at so finely, parts of the pitch, and each edge is then refined by bisection. A stretch of
/// low flow narrower than this may be passed over.
const LOOKS: u32 = 1024;

/// Most stretches of low flow in a pitch: a pulse has one, or a few if it is measured and uneven.
const MAX_STRETCHES: usize = 8;

/// Where the flow is low, as angles from the start of a pitch, rad; the last stretch may reach beyond its end.
struct LowFlow {
    stretches: [(f64, f64); MAX_STRETCHES],
    count: usize,
}

impl LowFlow {
    /// With each stretch shortened by `margin_rad` at either end.
    fn new(pump: &Pump, margin_rad: f64) -> Result<Self, PlanError> {
        let curve = pump.outlet_curve();
        let limit_ml_rad = LOW * pump.nominal_ml_rad();
        let (least_ml_rad, _) = curve.flow_range_ml_rad();
        if least_ml_rad > limit_ml_rad {
            return Err(PlanError::NoLowFlow { least_ml_rad, limit_ml_rad });
        }
        let is_low = |angle_rad: f64| curve.flow_ml_rad(angle_rad) <= limit_ml_rad;
        let mut found = Self { stretches: [(0.0, 0.0); MAX_STRETCHES], count: 0 };
        let look_rad = curve.pitch_rad() / f64::from(LOOKS);
        // From where the flow is high, once around: then no stretch is cut in two.
        let Some(first) = (0..LOOKS).find(|look| !is_low(f64::from(*look) * look_rad)) else {
            // Low throughout.
            return Ok(Self { stretches: [(0.0, curve.pitch_rad()); MAX_STRETCHES], count: 1 });
        };
        let mut begun_rad = None;
        let mut widest_rad: f64 = 0.0;
        for look in first..first + LOOKS {
            let (from_rad, to_rad) = (f64::from(look) * look_rad, f64::from(look + 1) * look_rad);
            match (is_low(from_rad), is_low(to_rad)) {
                (false, true) => begun_rad = Some(edge(curve, limit_ml_rad, from_rad, to_rad)),
                (true, false) => {
                    let ended_rad = edge(curve, limit_ml_rad, to_rad, from_rad);
                    let begun_rad = begun_rad.take().unwrap_or(from_rad);
                    widest_rad = widest_rad.max(ended_rad - begun_rad);
                    found.push(begun_rad + margin_rad, ended_rad - margin_rad);
                }
                _ => {}
            }
        }
        if found.count == 0 {
            let [half_width_deg, widest_deg] = [margin_rad, widest_rad].map(degrees);
            return Err(PlanError::LowFlowWithoutAngle { half_width_deg, widest_deg });
        }
        Ok(found)
    }

    fn push(&mut self, begun_rad: f64, ended_rad: f64) {
        if ended_rad >= begun_rad
            && let Some(place) = self.stretches.get_mut(self.count)
        {
            *place = (begun_rad, ended_rad);
            self.count += 1;
        }
    }

    fn stretches(&self) -> &[(f64, f64)] {
        self.stretches.get(..self.count).unwrap_or(&self.stretches)
    }
}

/// The angle between one of high and one of low flow where it becomes low, on the low side.
fn edge(curve: &FlowCurve, limit_ml_rad: f64, mut high_rad: f64, mut low_rad: f64) -> f64 {
    for _ in 0..60 {
        let middle_rad = 0.5 * (high_rad + low_rad);
        if curve.flow_ml_rad(middle_rad) <= limit_ml_rad {
            low_rad = middle_rad;
        } else {
            high_rad = middle_rad;
        }
    }
    low_rad
}

/// Steps, and the smallest and largest volume that they deliver, mL.
type End = (f64, (f64, f64));

/// The ends at low flow nearest to `nearest_steps` (itself counts as both): with no more steps and with no fewer, in the
/// direction of what is owed, not zero.
///
/// Refused where the flow of the pump never is that low, or the angle at the end would not be known well enough.
fn ends(
    pump: &Pump,
    start: Phase,
    owed_ml: f64,
    nearest_steps: f64,
    step_rad: f64,
) -> Result<[Option<End>; 2], PlanError> {
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
    // A coarse step may pass over a stretch; over a revolution it has met every one that it ever meets.
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
    Ok([below, above].map(|steps| steps.is_finite().then(|| end(steps))))
}

/// Of the two ends at low flow around `nearest_steps` the one whose worst deviation from what is owed is smaller.
pub(super) fn at_low_flow(
    pump: &Pump,
    start: Phase,
    request: &Request,
    nearest_steps: f64,
    step_rad: f64,
) -> Result<Target, PlanError> {
    let owed_ml = request.owed_ml();
    let ends = ends(pump, start, owed_ml, nearest_steps, step_rad)?;
    let off_ml = |(_, (least_ml, most_ml)): &End| (owed_ml - least_ml).abs().max((owed_ml - most_ml).abs());
    let nearer = match ends.into() {
        (Some(below), Some(above)) => Some(if off_ml(&below) <= off_ml(&above) { below } else { above }),
        (below, above) => below.or(above),
    };
    let Some((steps, range_ml)) = nearer else {
        return Err(PlanError::LowFlowTooNarrow { step_deg: degrees(step_rad) });
    };
    if off_ml(&(steps, range_ml)) > owed_ml.abs() {
        let smallest_ml = middle(range_ml) - request.carry_in_ml;
        return Err(PlanError::NoLowFlowEnd { requested_ml: request.volume_ml, smallest_ml });
    }
    Ok(Target { steps: steps as i64, planned_ml: middle(range_ml), range_ml })
}

impl Plan {
    /// Volumes, mL, of the ends at low flow next to what was asked and owed: the largest that is no more and the smallest that
    /// is no less, each none if there is none in the dose's direction. A dose of such a volume ends there and carries nothing.
    pub fn low_flow_volumes_ml(&self, pump: &Pump) -> Result<[Option<f64>; 2], PlanError> {
        let (curve, start_rad) = (pump.outlet_curve(), self.start.angle_rad);
        let owed_ml = self.requested_ml + self.carry_in_ml;
        let ideal_rad = curve.angle_rad(curve.volume_ml(start_rad) + owed_ml) - start_rad;
        let ends = ends(pump, self.start, owed_ml, floor(ideal_rad / self.step_rad + 0.5), self.step_rad)?;
        Ok(ends.map(|end| end.map(|(_, range_ml)| middle(range_ml))))
    }
}
