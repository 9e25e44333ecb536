//! How unsure a pulse that short doses found leaves the volume of a dose.

use libm::sqrt;
use pump_model::Pump;
use pump_model::units::wrap;

use crate::calibration::PulseSureness;
use crate::dosing::Swept;

/// Start angles by which the share of an angle between bounds is averaged.
const POINTS: i32 = 64;

/// Returns the standard uncertainty, in mL, that roller volume, engagement angle and zero leave to the turn.
///
/// Their joint covariance is propagated with the exact derivatives of the volume. `pump` is the corrected
/// pump, whose angles count from `zero_rad` of the model. Over the angles at which the rollers may stand the
/// share is the root of the mean variance.
pub(super) fn pulse_share_ml(pump: &Pump, swept: &Swept, pulse: &PulseSureness, zero_rad: f64) -> f64 {
    let (angle_rad, half_width_rad) = (swept.start.angle_rad(), swept.start.half_width_rad());
    let turn_rad = swept.end_rad - angle_rad;
    let variance = |start_rad| pulse.variance(slopes(pump, zero_rad, start_rad, start_rad + turn_rad));
    if half_width_rad == 0.0 {
        return sqrt(variance(angle_rad));
    }
    let half_width_rad = half_width_rad.min(0.5 * pump.pitch_rad());
    let place = |n| angle_rad + half_width_rad * ((2.0 * f64::from(n) + 1.0) / f64::from(POINTS) - 1.0);
    sqrt((0..POINTS).map(|n| variance(place(n))).sum::<f64>() / f64::from(POINTS))
}

/// Returns the derivatives of the volume of a turn, in mL, by V_r over V_r, by phi in rad and by the zero in
/// rad. The volume of a revolution is held.
///
/// With q = a - sum g(phi - p), p the angle of a roller since it began to leave, and V(x) = V_r W(x/phi):
/// - the rollers take a turn - volume, in proportion to V_r. All volumes then rise so that a revolution keeps
///   its own, by NU V_r/V_rot.
/// - a roller at p has g(phi - p) p/phi more to give for each radian of phi.
/// - a zero shifts both ends of the turn.
fn slopes(pump: &Pump, zero_rad: f64, from_rad: f64, to_rad: f64) -> [f64; 3] {
    let (curve, roller) = (pump.outlet_curve(), pump.roller_volume());
    let volume_ml = curve.volume_ml(to_rad) - curve.volume_ml(from_rad);
    let taken_ml = pump.nominal_ml_rad() * (to_rad - from_rad) - volume_ml;
    let rollers_ml = f64::from(pump.geometry().rollers) * roller.total_ml();
    let phi_rad = roller.engagement_rad();
    let given_ml_rad = |angle_rad: f64| {
        let mut away_rad = wrap(angle_rad + zero_rad, pump.pitch_rad());
        let mut sum = 0.0;
        while away_rad < phi_rad {
            sum += roller.slope_ml_rad(phi_rad - away_rad) * away_rad / phi_rad;
            away_rad += pump.pitch_rad();
        }
        sum
    };
    [
        volume_ml * rollers_ml / pump.revolution_ml() - taken_ml,
        given_ml_rad(to_rad) - given_ml_rad(from_rad),
        curve.flow_ml_rad(to_rad) - curve.flow_ml_rad(from_rad),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::displacement::{Correction, PulseCorrection};

    #[test]
    fn the_derivatives_are_the_differences_of_pumps_beside() {
        const STEP: f64 = 1e-6;
        let drawn = crate::catalogue::built_in("three-roller-as-built").map(|file| file.model().unwrap());
        let eight = {
            let base = Pump::three_roller();
            let mut geometry = *base.geometry();
            geometry.rollers = 8;
            // Pulses overlap: a pitch of 45 deg is less than phi.
            Pump::new(geometry, *base.roller_volume(), *base.inlet(), *base.outlet()).unwrap()
        };
        for base in [Pump::three_roller(), Pump::two_roller(), eight].into_iter().chain(drawn) {
            let roller = base.roller_volume();
            let (volume_ml, phi_deg) = (1.04 * roller.total_ml(), 0.98 * roller.engagement_deg());
            let with = |volume: f64, phi_rad: f64, zero_rad: f64| {
                let pulse = PulseCorrection {
                    roller_volume_ml: volume_ml * (1.0 + volume),
                    engagement_deg: phi_deg + phi_rad.to_degrees(),
                };
                let correction = Correction { factor: 1.013, zero_rad: 0.31 + zero_rad, pulse: Some(pulse) };
                correction.of(&base).unwrap()
            };
            let pump = with(0.0, 0.0, 0.0);
            for (from_rad, turn_rad) in [(0.05, 0.2), (0.33, 0.4), (1.1, 0.9), (-0.4, -0.3), (0.2, 7.0)] {
                let volume = |pump: &Pump| {
                    let curve = pump.outlet_curve();
                    curve.volume_ml(from_rad + turn_rad) - curve.volume_ml(from_rad)
                };
                let beside = |more: &Pump, less: &Pump| (volume(more) - volume(less)) / (2.0 * STEP);
                let expected = [
                    beside(&with(STEP, 0.0, 0.0), &with(-STEP, 0.0, 0.0)),
                    beside(&with(0.0, STEP, 0.0), &with(0.0, -STEP, 0.0)),
                    beside(&with(0.0, 0.0, STEP), &with(0.0, 0.0, -STEP)),
                ];
                let found = slopes(&pump, 0.31, from_rad, from_rad + turn_rad);
                for (found, expected) in found.into_iter().zip(expected) {
                    assert!((found - expected).abs() < 2e-5, "{from_rad} {turn_rad}: {found} {expected}");
                }
            }
        }
    }
}
