//! The share of the default pulse of a head that is known by its volume alone.

use core::f64::consts::TAU;

use libm::{floor, sqrt};
use pump_model::units::wrap;
use pump_model::{Pump, RollerVolume};

use super::Budget;
use super::share::{Share, ShareSource};
use crate::calibration::Applied;
use crate::displacement::PulsePrior;
use crate::dosing::Swept;
use crate::pump_file::PumpFile;

/// Factor by which the spread of the drawings is widened once more: six drawings show it only roughly.
const WIDER: f64 = 1.5;

/// Nodes and weights of the Gauss-Hermite quadrature of a normal distribution with five nodes (Abramowitz and Stegun,
/// table 25.10: sqrt(2) x_i and w_i/sqrt(pi)).
const NODES: [(f64, f64); 5] = [
    (-2.856_970_013_872_806, 0.011_257_411_327_720_7),
    (-1.355_626_179_974_266, 0.222_075_922_005_612_7),
    (0.0, 0.533_333_333_333_333_3),
    (1.355_626_179_974_266, 0.222_075_922_005_612_7),
    (2.856_970_013_872_806, 0.011_257_411_327_720_7),
];

/// Start angles by which the share of an angle between bounds is averaged.
const POINTS: u32 = 16;

impl Budget {
    /// Returns the budget with the share of the default pulse, if the pump of `file` is known by its volume alone and
    /// no short doses have found its pulse.
    ///
    /// The share is the root of the mean square difference of the turn's volume over the pulses that heads may have. A
    /// revolution keeps its volume. The differences are far from linear in the pulse, so they are integrated.
    #[must_use]
    pub(crate) fn with_default_pulse(
        mut self,
        file: &PumpFile,
        pump: &Pump,
        swept: &Swept,
        applied: Option<&Applied>,
    ) -> Self {
        let Some(prior) =
            file.pulse_prior().filter(|_| applied.is_none_or(|applied| applied.pulse.is_none()))
        else {
            return self;
        };
        let zero_rad = applied.map_or(0.0, |applied| applied.correction.zero_rad);
        self.shares.push(Share::new(ShareSource::Pulse, share_ml(&prior, pump, swept, zero_rad)));
        self.with_percentages()
    }
}

/// Returns the standard uncertainty that the default pulse leaves to the turn, in mL.
fn share_ml(prior: &PulsePrior, pump: &Pump, swept: &Swept, zero_rad: f64) -> f64 {
    let pitch_ml = pump.outlet_curve().pitch_ml();
    let (angle_rad, half_width_rad) = (swept.start.angle_rad(), swept.start.half_width_rad());
    let turn_rad = swept.end_rad - angle_rad;
    let half_width_rad = half_width_rad.min(0.5 * pump.pitch_rad());
    let points = if half_width_rad == 0.0 { 1 } else { POINTS };
    let places = (0..points).map(|n| {
        let part = (2.0 * f64::from(n) + 1.0) / f64::from(points) - 1.0;
        angle_rad + half_width_rad * part + zero_rad
    });
    let places: Vec<f64> = places.collect();
    let volume_ml =
        |roller: &RollerVolume, from_rad| turn_ml(prior.rollers, pitch_ml, roller, from_rad, turn_rad);
    let Ok(default) = prior.roller_volume_at(pitch_ml, [0.0, 0.0]) else { return 0.0 };
    let mut variance = 0.0;
    for (angle, angle_weight) in NODES {
        for (fullness, fullness_weight) in NODES {
            let Ok(roller) = prior.roller_volume_at(pitch_ml, [WIDER * angle, WIDER * fullness]) else {
                continue;
            };
            let square = |from_rad: &f64| {
                let difference_ml = volume_ml(&roller, *from_rad) - volume_ml(&default, *from_rad);
                difference_ml * difference_ml
            };
            let mean = places.iter().map(square).sum::<f64>() / f64::from(points);
            variance += angle_weight * fullness_weight * mean;
        }
    }
    sqrt(variance)
}

/// Returns the volume of a turn of a head that delivers `pitch_ml` a pitch, in mL, angles of the model.
///
/// The bore delivers a times the turn, a = (V_pitch + V_r)/pitch, and each roller that leaves takes V_r on the way. A
/// roller that began to leave p ago has V(phi - p) left to take (McIntyre et al.: q = a - sum g(phi - p)).
fn turn_ml(rollers: u32, pitch_ml: f64, roller: &RollerVolume, from_rad: f64, turn_rad: f64) -> f64 {
    let pitch_rad = TAU / f64::from(rollers);
    let phi_rad = roller.engagement_rad();
    let taken_ml = |angle_rad: f64| {
        let mut away_rad = wrap(angle_rad, pitch_rad);
        let mut sum = floor(angle_rad / pitch_rad) * roller.total_ml();
        while away_rad < phi_rad {
            sum -= roller.at(phi_rad - away_rad);
            away_rad += pitch_rad;
        }
        sum
    };
    let nominal_ml_rad = (pitch_ml + roller.total_ml()) / pitch_rad;
    nominal_ml_rad * turn_rad - (taken_ml(from_rad + turn_rad) - taken_ml(from_rad))
}

#[cfg(test)]
mod tests {
    use pump_model::{DefaultPulse, Line};

    use super::*;

    #[test]
    fn the_volume_of_a_turn_is_that_of_the_models_flow_curve() {
        for (rollers, share, engagement_deg) in
            [(4, 0.25, 55.0), (3, 0.2, 61.0), (8, 0.3, 60.0), (2, 0.1, 200.0)]
        {
            let pulse = DefaultPulse::new(share, engagement_deg);
            let pump = Pump::from_ml_per_rev(0.5, rollers, pulse, Line::PUBLISHED, Line::PUBLISHED).unwrap();
            let (curve, pitch_ml) = (pump.outlet_curve(), pump.outlet_curve().pitch_ml());
            for (from_rad, turn_rad) in [(0.05, 0.2), (0.33, 1.4), (1.1, 9.0), (-0.4, -0.3), (0.2, 70.0)] {
                let expected_ml = curve.volume_ml(from_rad + turn_rad) - curve.volume_ml(from_rad);
                let found_ml = turn_ml(rollers, pitch_ml, pump.roller_volume(), from_rad, turn_rad);
                assert!(
                    (found_ml - expected_ml).abs() < 1e-12,
                    "{rollers} {from_rad}: {found_ml} {expected_ml}"
                );
            }
        }
    }

    #[test]
    fn the_quadrature_has_the_moments_of_a_normal_distribution() {
        for (power, moment) in [(0, 1.0), (2, 1.0), (4, 3.0), (6, 15.0), (8, 105.0)] {
            let sum: f64 = NODES.iter().map(|(node, weight)| weight * node.powi(power)).sum();
            assert!((sum / moment - 1.0).abs() < 1e-9, "{power}: {sum}");
        }
    }

    #[test]
    fn whole_pitches_have_no_share_and_half_a_pitch_has_one() {
        let (prior, pitch_ml) = (PulsePrior::of(4), 0.125);
        let pump = Pump::from_ml_per_rev(0.5, 4, prior.pulse(), Line::PUBLISHED, Line::PUBLISHED).unwrap();
        let of = |turn_rad: f64| {
            let start = pump_ctl::plan::Phase::known(0.3);
            let end_rad = 0.3 + turn_rad;
            let swept = Swept {
                start,
                end_rad,
                volume_ml: 0.0,
                range_ml: (0.0, 0.0),
                end_step_ml: 0.0,
                carry_in_ml: 0.0,
            };
            share_ml(&prior, &pump, &swept, 0.0)
        };
        assert!(of(3.0 * TAU / 4.0) < 1e-14);
        let half_ml = of(TAU / 8.0);
        assert!(half_ml > 0.02 * pitch_ml && half_ml < 0.5 * pitch_ml, "{half_ml}");
    }
}
