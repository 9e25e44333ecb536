//! Claims about turns whose start angle is only known to lie in an interval, against a fine grid of start
//! angles.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use proptest::prelude::*;
use pump_model::{FlowCurve, Pump, Variant};

const POINTS: u32 = 400;

/// Returns the volume of a turn from `start_rad`, mL.
fn turned_ml(curve: &FlowCurve, start_rad: f64, turn_rad: f64) -> f64 {
    curve.volume_ml(start_rad + turn_rad) - curve.volume_ml(start_rad)
}

/// Returns the largest of `value` over `[low, high]`: every summit of a grid, refined by ternary search
/// beside it.
fn largest(value: impl Fn(f64) -> f64, low: f64, high: f64) -> f64 {
    let at = |n: u32| low + (high - low) * f64::from(n) / f64::from(POINTS);
    let refined = |n: u32| {
        let (mut left, mut right) = (at(n.saturating_sub(1)), at((n + 1).min(POINTS)));
        for _ in 0..60 {
            let (a, b) = (left + (right - left) / 3.0, right - (right - left) / 3.0);
            if value(a) < value(b) { left = a } else { right = b }
        }
        value(at(n)).max(value(0.5 * (left + right)))
    };
    let is_summit = |n: &u32| {
        let beside = [n.saturating_sub(1), (n + 1).min(POINTS)];
        beside.into_iter().all(|beside| value(at(beside)) <= value(at(*n)))
    };
    (0..=POINTS).filter(is_summit).map(refined).fold(f64::NEG_INFINITY, f64::max)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, ..ProptestConfig::default() })]

    #[test]
    fn the_range_holds_every_start_angle_and_both_its_ends_are_attained(
        rollers in 2u32..=11,
        start in -10.0..10.0_f64,
        width in prop_oneof![Just(10.0), 0.0..1.5_f64, 1e-6..1e-3_f64],
        turn in prop_oneof![-20.0..20.0_f64, -0.01..0.01_f64],
    ) {
        let pump = Pump::preset(rollers, Variant::Measured).unwrap();
        let curve = pump.outlet_curve();
        let (least, most) = curve.turn_range_ml(start, width, turn);
        let width = width.min(0.5 * curve.pitch_rad());
        let found_most = largest(|start| turned_ml(curve, start, turn), start - width, start + width);
        let found_least = -largest(|start| -turned_ml(curve, start, turn), start - width, start + width);
        prop_assert!(least <= found_least + 1e-12 && found_most <= most + 1e-12,
            "{least} {found_least} {found_most} {most}");
        prop_assert!(found_least - least < 1e-9 && most - found_most < 1e-9,
            "{least} {found_least} {found_most} {most}");
    }

    #[test]
    fn whole_pitches_deliver_the_same_from_anywhere(
        rollers in 2u32..=11,
        pitches in -10i32..=10,
        start in -10.0..10.0_f64,
        width in 0.0..3.0_f64,
    ) {
        let pump = Pump::preset(rollers, Variant::Measured).unwrap();
        let curve = pump.outlet_curve();
        let (least, most) = curve.turn_range_ml(start, width, f64::from(pitches) * curve.pitch_rad());
        prop_assert!((0.0..1e-12).contains(&(most - least)),
            "{least} {most}");
        prop_assert!((most - f64::from(pitches) * curve.pitch_ml()).abs() < 1e-12, "{most}");
    }

    #[test]
    fn both_ends_of_the_range_grow_with_the_turn(start in 0.0..6.0_f64, width in 0.0..3.0_f64, turn in -9.0..9.0_f64) {
        let pump = Pump::three_roller();
        let range = |turn| pump.outlet_curve().turn_range_ml(start, width, turn);
        let ((least, most), (more_least, more_most)) = (range(turn), range(turn + 0.0005));
        prop_assert!(more_least > least && more_most > most);
    }
}
