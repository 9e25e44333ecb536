//! The error that the tolerance of the start angle leaves in a dose.
//!
//! A turn from theta + e delivers V(theta + e + turn) - V(theta + e). Its error changes with e by the flow per radian
//! at the end less that at the start. That flow dips over a pulse and is level between pulses, so the error is neither
//! normal nor uniform. It is computed over the width itself, and not from its slope at theta.

use libm::{erf, hypot, sqrt};
use pump_model::Pump;

use crate::dosing::swept::Swept;

/// Number of angles over the width at which the error is computed.
const ANGLES: i32 = 256;

/// Part of the doses that lie within the expanded uncertainty. It is that of two standard deviations of a normal
/// distribution, erf(sqrt 2) (GUM, JCGM 100:2008, table G.1).
const COVERAGE: f64 = 0.954_499_736_103_641_6;

/// Largest error of an expanded uncertainty, as a part of it.
const PRECISION: f64 = 1e-6;

/// Errors of a dose, in mL, from angles that are equally likely.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct AngleErrors {
    /// Volume from each angle less the planned volume, in mL. There are none if the angle is exact.
    errors_ml: Vec<f64>,
    /// True if the dose was planned from the angle itself, and not for the worst case over the angles.
    is_stated: bool,
    /// Errors over pulses as well as angles, in the place of those over angles alone.
    joint: Option<JointErrors>,
}

/// Errors over the pulses that a head may have and the angles at which its rollers may stand.
#[derive(Debug, Clone, PartialEq)]
struct JointErrors {
    /// Volume with each pulse from each angle less the planned volume, in mL.
    errors_ml: Vec<f64>,
    /// Standard uncertainty of the shares that these errors take the place of, in mL.
    standard_ml: f64,
}

impl AngleErrors {
    /// Computes the errors of a turn over the width of its start angle. Start and end angle shift together.
    pub(super) fn of(pump: &Pump, swept: &Swept) -> Self {
        let (angle_rad, half_width_rad) = (swept.start.angle_rad(), swept.start.half_width_rad());
        if half_width_rad == 0.0 {
            return Self { errors_ml: Vec::new(), is_stated: true, joint: None };
        }
        // Beyond half a pitch every angle within the pitch is equally likely.
        let half_width_rad = half_width_rad.min(0.5 * pump.pitch_rad());
        let (curve, turn_rad) = (pump.outlet_curve(), swept.end_rad - angle_rad);
        let error_ml = |n: i32| {
            let part = f64::from(2 * n + 1) / f64::from(ANGLES) - 1.0;
            let start_rad = angle_rad + half_width_rad * part;
            curve.volume_ml(start_rad + turn_rad) - curve.volume_ml(start_rad) - swept.volume_ml
        };
        let is_stated = swept.start.is_stated();
        Self { errors_ml: (0..ANGLES).map(error_ml).collect(), is_stated, joint: None }
    }

    /// Returns these errors with those of the volume over pulses and angles, whose share of the pulses is
    /// `pulse_ml`.
    pub(super) fn joined_by(self, errors_ml: Vec<f64>, pulse_ml: f64) -> Self {
        let standard_ml = hypot(self.standard_ml(), pulse_ml);
        Self { joint: Some(JointErrors { errors_ml, standard_ml }), ..self }
    }

    /// Returns the shares of a stated angle and of an angle that is known less well, in mL. One of them is 0.
    pub(super) fn shares_ml(&self) -> [f64; 2] {
        let standard_ml = self.standard_ml();
        if self.is_stated { [standard_ml, 0.0] } else { [0.0, standard_ml] }
    }

    /// Returns the root of the mean square error, in mL. Of an angle that is not stated it is half of the largest error
    /// at least: a dose that was planned for the sum with earlier ones may lie on one side of its own volumes.
    fn standard_ml(&self) -> f64 {
        let count = self.errors_ml.len().max(1) as f64;
        let mean_ml =
            sqrt(self.errors_ml.iter().fold(0.0, |sum, error_ml| sum + error_ml * error_ml) / count);
        if self.is_stated { mean_ml } else { mean_ml.max(0.5 * farthest_ml(&self.errors_ml)) }
    }

    /// Returns the expanded uncertainty, in mL, of a budget whose combined standard uncertainty is `all_ml`, if the
    /// distribution of these errors is propagated. `None` if they are none, or part of the normal errors.
    pub(super) fn expanded_ml(&self, all_ml: f64) -> Option<f64> {
        let (errors_ml, standard_ml) = match &self.joint {
            Some(joint) => (&joint.errors_ml, joint.standard_ml),
            None => (&self.errors_ml, self.shares_ml()[0]),
        };
        if standard_ml == 0.0 {
            return None;
        }
        let others_ml = sqrt((all_ml * all_ml - standard_ml * standard_ml).max(0.0));
        Some(expanded_ml(errors_ml, others_ml))
    }
}

/// Returns the largest of some errors either way, in mL.
fn farthest_ml(errors_ml: &[f64]) -> f64 {
    errors_ml.iter().fold(0.0_f64, |most, error_ml| most.max(error_ml.abs()))
}

/// Returns the expanded uncertainty, in mL, of errors together with independent normal ones whose standard uncertainty
/// is `others_ml`.
///
/// The distributions are propagated (JCGM 101:2008) instead of their variances: k = 2 would cover every dose where
/// bounded errors dominate.
fn expanded_ml(errors_ml: &[f64], others_ml: f64) -> f64 {
    let farthest_ml = farthest_ml(errors_ml);
    // The farthest error and two standard deviations cover enough from every angle.
    let (mut least_ml, mut most_ml) = (0.0, farthest_ml + 2.0 * others_ml);
    if farthest_ml == 0.0 {
        return most_ml;
    }
    while most_ml - least_ml > PRECISION * most_ml {
        let middle_ml = 0.5 * (least_ml + most_ml);
        if covered(errors_ml, middle_ml, others_ml) < COVERAGE {
            least_ml = middle_ml;
        } else {
            most_ml = middle_ml;
        }
    }
    most_ml
}

/// Returns the part of the doses whose error is `within_ml` at most.
fn covered(errors_ml: &[f64], within_ml: f64, others_ml: f64) -> f64 {
    // Errors alone are a staircase. A thousandth of the width smooths it and is far below its steps.
    let scale_ml = std::f64::consts::SQRT_2 * others_ml.max(1e-3 * within_ml);
    // erf is 1 to the last bit but one beyond 5.9, where most errors lie.
    let erf_of = |ml: f64| if ml.abs() > 6.0 * scale_ml { ml.signum() } else { erf(ml / scale_ml) };
    let part = |error_ml: &f64| 0.5 * (erf_of(within_ml - error_ml) + erf_of(within_ml + error_ml));
    errors_ml.iter().map(part).sum::<f64>() / errors_ml.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use pump_ctl::plan::Phase;
    use pump_model::units::radians;

    use super::*;

    fn swept(pump: &Pump, start: Phase, turn_rad: f64) -> Swept {
        let (curve, start_rad) = (pump.outlet_curve(), start.angle_rad());
        let volume_ml = curve.volume_ml(start_rad + turn_rad) - curve.volume_ml(start_rad);
        let range_ml = start.range_ml(pump, turn_rad);
        let end_rad = start_rad + turn_rad;
        Swept { start, end_rad, volume_ml, range_ml, end_step_ml: 0.0, carry_in_ml: 0.0 }
    }

    #[test]
    fn errors_that_are_uniform_expand_to_the_interval_of_a_uniform_distribution() {
        let errors_ml = (0..256).map(|n| (2.0 * f64::from(n) + 1.0) / 256.0 - 1.0).collect();
        let errors = AngleErrors { errors_ml, is_stated: true, joint: None };
        assert!((errors.standard_ml() - 1.0 / 3_f64.sqrt()).abs() < 1e-5);
        // Alone 95.45 % of them lie within 0.9545 of the bound.
        let alone = errors.expanded_ml(errors.standard_ml()).unwrap();
        assert!((alone - COVERAGE).abs() < 5e-3, "{alone}");
        // With a normal error that dominates the variances add up: k = 2.
        let combined = (1.0 / 3.0 + 100.0_f64).sqrt();
        assert!((errors.expanded_ml(combined).unwrap() / combined - 2.0).abs() < 1e-3);
    }

    #[test]
    fn an_exact_angle_or_whole_pitches_leave_k_at_two() {
        let pump = Pump::three_roller();
        for (half_width_rad, turn_rad) in
            [(0.0, 0.3), (0.02, pump.pitch_rad()), (1.0, -2.0 * pump.pitch_rad())]
        {
            let errors = AngleErrors::of(&pump, &swept(&pump, Phase::within(0.4, half_width_rad), turn_rad));
            assert!(errors.standard_ml() < 1e-12);
            assert!(errors.expanded_ml(0.1).is_none_or(|expanded_ml| (expanded_ml - 0.2).abs() < 1e-6));
        }
    }

    #[test]
    fn the_errors_reach_over_the_range_of_the_volume_and_are_largest_where_a_dose_ends_in_a_pulse() {
        let pump = Pump::three_roller();
        let of = |start_deg: f64, turn_deg: f64| {
            let start = Phase::within(radians(start_deg), radians(1.0));
            let swept = swept(&pump, start, radians(turn_deg));
            (AngleErrors::of(&pump, &swept), swept)
        };
        for (start_deg, turn_deg) in [(0.0, 20.0), (30.0, 50.0), (50.0, 100.0), (45.0, -30.0)] {
            let (errors, Swept { range_ml, volume_ml, .. }) = of(start_deg, turn_deg);
            let least_ml = errors.errors_ml.iter().copied().fold(f64::INFINITY, f64::min);
            let most_ml = errors.errors_ml.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let width_ml = range_ml.1 - range_ml.0;
            assert!(least_ml >= range_ml.0 - volume_ml - 1e-12 && most_ml <= range_ml.1 - volume_ml + 1e-12);
            assert!(most_ml - least_ml > 0.98 * width_ml, "{start_deg} {turn_deg}: {least_ml} {most_ml}");
        }
        // From between the pulses to the deepest flow, 0.405 of 4.398 mL/rad, a degree is worth 0.0697 mL.
        let deepest_deg = (0..1200).map(|n| 0.1 * f64::from(n));
        let flow = |deg: &f64| pump.outlet_curve().flow_ml_rad(radians(*deg));
        let deepest_deg = deepest_deg.min_by(|a, b| flow(a).total_cmp(&flow(b))).unwrap();
        let (errors, _) = of(80.0, deepest_deg + 120.0 - 80.0);
        let slope_ml = radians(1.0) * (4.398_229_7 - 0.405);
        assert!((errors.standard_ml() * 3_f64.sqrt() / slope_ml - 1.0).abs() < 0.01, "{errors:?}");
    }
}
