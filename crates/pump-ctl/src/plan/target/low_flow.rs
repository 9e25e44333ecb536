//! The stretches of a pitch in which the flow is low.

use pump_model::units::degrees;
use pump_model::{FlowCurve, Pump};

use crate::plan::words::PlanError;

/// Part of the flow between pulses that counts as low.
///
/// The flow falls to half within a pulse of every pump whose rollers displace more than half of it at once.
/// Half is also far from the begin and the end of a pulse, so rounding does not decide where in the pitch a
/// dose ends.
const LOW: f64 = 0.5;

/// Number of parts of a pitch at whose ends the search looks at the flow. Bisection then refines each edge.
/// The search may pass over a stretch of low flow that is narrower than a part.
const LOOKS: u32 = 1024;

/// Largest number of stretches of low flow in a pitch. A pulse has one, or a few if it is measured and
/// uneven.
const MAX_STRETCHES: usize = 8;

/// The stretches of low flow, as angles from the start of a pitch, rad. The last stretch may reach beyond the
/// pitch's end.
pub(super) struct LowFlow {
    stretches: [(f64, f64); MAX_STRETCHES],
    count: usize,
}

impl LowFlow {
    /// Finds the stretches of a pump's outlet, each shortened by `margin_rad` at either end.
    pub(super) fn new(pump: &Pump, margin_rad: f64) -> Result<Self, PlanError> {
        let curve = pump.outlet_curve();
        let limit_ml_rad = LOW * pump.nominal_ml_rad();
        let (least_ml_rad, _) = curve.flow_range_ml_rad();
        if least_ml_rad > limit_ml_rad {
            return Err(PlanError::NoLowFlow { least_ml_rad, limit_ml_rad });
        }
        let is_low = |angle_rad: f64| counts(curve.flow_ml_rad(angle_rad), limit_ml_rad);
        let mut found = Self { stretches: [(0.0, 0.0); MAX_STRETCHES], count: 0 };
        let look_rad = curve.pitch_rad() / f64::from(LOOKS);
        // The search starts where the flow is high and goes once around, so no stretch is cut in two.
        let Some(first) = (0..LOOKS).find(|look| !is_low(f64::from(*look) * look_rad)) else {
            // The flow is low throughout.
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

    /// Returns the stretches, in order.
    pub(super) fn stretches(&self) -> &[(f64, f64)] {
        self.stretches.get(..self.count).unwrap_or(&self.stretches)
    }
}

/// Returns true if a flow per radian is low: positive, and no more than the limit. A flow that reverses takes back
/// what was delivered, so no dose ends there.
fn counts(flow_ml_rad: f64, limit_ml_rad: f64) -> bool {
    flow_ml_rad > 0.0 && flow_ml_rad <= limit_ml_rad
}

/// Finds the angle between `high_rad` and `low_rad` at which the flow becomes low, on the low side.
fn edge(curve: &FlowCurve, limit_ml_rad: f64, mut high_rad: f64, mut low_rad: f64) -> f64 {
    for _ in 0..60 {
        let middle_rad = 0.5 * (high_rad + low_rad);
        if counts(curve.flow_ml_rad(middle_rad), limit_ml_rad) {
            low_rad = middle_rad;
        } else {
            high_rad = middle_rad;
        }
    }
    low_rad
}
