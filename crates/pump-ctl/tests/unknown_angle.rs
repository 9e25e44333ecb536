//! Claims about doses whose start angle is not known, or only to lie in an interval.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use proptest::prelude::*;
use pump_ctl::plan::{
    Cruise, Doser, Finish, Limits, Motor, Phase, Plan, PlanError, Request, Retarget, Turned,
};
use pump_model::Pump;

/// Half width below which an angle counts as stated, rad.
const TWO_DEG: f64 = std::f64::consts::PI / 90.0;

const FLOW: Cruise = Cruise::Flow { ml_s: 5.0 };

/// Makes the motor of the built-in pumps, with a number of steps.
fn limits(steps_per_rev: f64) -> Limits {
    Limits::new(Motor::new(steps_per_rev, 17.8, 500.0))
}

fn pump(rollers: u32) -> Pump {
    if rollers == 3 { Pump::three_roller() } else { Pump::two_roller() }
}

fn planned(pump: &Pump, start: Phase, volume_ml: f64) -> Plan {
    Doser::new(pump, limits(12_800.0)).unwrap().plan(start, &Request::new(volume_ml, FLOW)).unwrap()
}

/// Returns the largest deviation of `steps` from `owed_ml`, over all angles that `start` may be, mL.
fn worst_ml(pump: &Pump, start: Phase, steps: i64, owed_ml: f64) -> f64 {
    let (least_ml, most_ml) = start.range_ml(pump, steps as f64 * limits(12_800.0).motor.step_rad());
    (owed_ml - least_ml).max(most_ml - owed_ml)
}

/// Returns the largest deviation of `steps` from `owed_ml` over a grid of the angles, mL. The grid misses the
/// extremes by half a microlitre at most.
fn worst_on_a_grid_ml(pump: &Pump, start: Phase, steps: i64, owed_ml: f64) -> f64 {
    const POINTS: i32 = 2000;
    let half_width_rad = start.half_width_rad().min(0.5 * pump.pitch_rad());
    let curve = pump.outlet_curve();
    let turn_rad = steps as f64 * limits(12_800.0).motor.step_rad();
    (0..=POINTS)
        .map(|n| start.angle_rad() + half_width_rad * (2.0 * f64::from(n) / f64::from(POINTS) - 1.0))
        .map(|angle_rad| curve.volume_ml(angle_rad + turn_rad) - curve.volume_ml(angle_rad))
        .map(|volume_ml| (volume_ml - owed_ml).abs())
        .fold(0.0, f64::max)
}

fn any_volume() -> impl Strategy<Value = f64> {
    (prop_oneof![0.01..60.0_f64, 0.01..1.0_f64], any::<bool>())
        .prop_map(|(ml, back)| if back { -ml } else { ml })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    #[test]
    fn no_other_number_of_steps_has_a_smaller_worst_case(
        rollers in 2u32..=3,
        volume in any_volume(),
        angle_rad in 0.0..6.0_f64,
        half_width_rad in prop_oneof![Just(2.0), TWO_DEG..0.8_f64],
        farther in 2i64..3000,
    ) {
        let pump = pump(rollers);
        let start = Phase::within(angle_rad, half_width_rad);
        let plan = planned(&pump, start, volume);
        let worst = worst_ml(&pump, start, plan.steps(), volume);
        for other in [1, 2, farther].into_iter().flat_map(|away| [plan.steps() - away, plan.steps() + away]) {
            prop_assert!(worst_ml(&pump, start, other, volume) > worst - 1e-12, "{} {other}", plan.steps());
            let on_a_grid = worst_on_a_grid_ml(&pump, start, other, volume);
            prop_assert!(on_a_grid > worst - 5e-4, "{} {other}", plan.steps());
        }
    }

    #[test]
    fn the_plan_says_between_which_volumes_it_delivers_and_plans_their_middle(
        rollers in 2u32..=3,
        volume in any_volume(),
        angle_rad in 0.0..6.0_f64,
        half_width_rad in prop_oneof![Just(2.0), TWO_DEG..0.8_f64],
    ) {
        let pump = pump(rollers);
        let start = Phase::within(angle_rad, half_width_rad);
        let plan = planned(&pump, start, volume);
        let farthest = (volume - plan.least_ml()).max(plan.most_ml() - volume);
        let found = worst_on_a_grid_ml(&pump, start, plan.steps(), volume);
        prop_assert!(found <= farthest + 1e-12 && found > farthest - 5e-4, "{found} {farthest}");
        prop_assert!((plan.planned_ml() - 0.5 * (plan.least_ml() + plan.most_ml())).abs() < 1e-12);
        prop_assert!((plan.planned_ml() + plan.carry_ml() - volume).abs() < 1e-12);
        // The bound is half of the largest step.
        prop_assert!(plan.carry_ml().abs() <= 0.5 * 4.4 * plan.step_rad() + 1e-12);
        let made = plan.steps().unsigned_abs();
        prop_assert_eq!(plan.delivered_ml(&pump, made).to_bits(), plan.planned_ml().to_bits());
        prop_assert_eq!(plan.range_ml(&pump, made), (plan.least_ml(), plan.most_ml()));
    }

    #[test]
    fn every_angle_is_the_same_when_none_is_known(volume in any_volume(), angle_rad in 0.0..6.0_f64) {
        let pump = pump(3);
        let unknown = planned(&pump, Phase::unknown(pump.pitch_rad()), volume);
        let anywhere = planned(&pump, Phase::within(angle_rad, 50.0), volume);
        prop_assert_eq!(unknown.steps(), anywhere.steps());
        prop_assert!((unknown.least_ml() - anywhere.least_ml()).abs() < 1e-12);
        prop_assert!((unknown.most_ml() - anywhere.most_ml()).abs() < 1e-12);
    }

    #[test]
    fn an_angle_stated_to_less_than_two_degrees_gives_the_bits_of_the_known_one_and_its_own_range(
        rollers in 2u32..=3,
        volume in any_volume(),
        angle_rad in 0.0..6.0_f64,
        half_width_rad in 1e-9..TWO_DEG,
        finish in prop_oneof![Just(Finish::Any), Just(Finish::LowFlow)],
    ) {
        let pump = pump(rollers);
        let doser = Doser::new(&pump, limits(12_800.0)).unwrap();
        let request = Request::new(volume, FLOW).with_finish(finish);
        let start = Phase::within(angle_rad, half_width_rad);
        let (Ok(known), Ok(stated)) =
            (doser.plan(Phase::known(angle_rad), &request), doser.plan(start, &request))
        else {
            // Within its tolerance there may be no end at low flow.
            prop_assert_eq!(finish, Finish::LowFlow);
            return Ok(());
        };
        let margin_steps = (half_width_rad / known.step_rad()).ceil() as u64;
        if finish == Finish::Any {
            prop_assert_eq!(known.steps(), stated.steps());
            prop_assert_eq!(known.planned_ml().to_bits(), stated.planned_ml().to_bits());
            prop_assert_eq!(known.carry_ml().to_bits(), stated.carry_ml().to_bits());
        } else if known.steps().signum() == stated.steps().signum() {
            // The end keeps its tolerance from the edges of the low flow, or is the next one.
            let pitch_steps = 12_800 / u64::from(rollers);
            let off = known.steps().abs_diff(stated.steps());
            prop_assert!(off <= margin_steps + 1 || off > pitch_steps / 2, "{off} steps");
        }
        let (least_ml, most_ml) = (stated.least_ml() - 1e-12, stated.most_ml() + 1e-12);
        prop_assert!((least_ml..=most_ml).contains(&stated.planned_ml()), "{stated:?}");
        let width = worst_on_a_grid_ml(&pump, start, stated.steps(), stated.planned_ml());
        let farthest = (stated.planned_ml() - stated.least_ml()).max(stated.most_ml() - stated.planned_ml());
        prop_assert!(width <= farthest + 1e-12 && width > farthest - 5e-4, "{width} {farthest}");
    }

    #[test]
    fn doses_from_a_stated_angle_add_up_to_the_volume_from_that_very_angle(
        volumes in proptest::collection::vec(any_volume(), 1..6),
        angle_rad in 0.0..6.0_f64,
        half_width_rad in 1e-6..TWO_DEG,
    ) {
        let pump = pump(3);
        let doser = Doser::new(&pump, limits(12_800.0)).unwrap();
        let first = Phase::within(angle_rad, half_width_rad);
        let (mut turned, mut carry_ml, mut planned_ml) = (Turned::at(first), 0.0, 0.0);
        for volume in &volumes {
            let start = first.moved_to(angle_rad + turned.least_rad);
            let request = Request::new(*volume, FLOW).with_carry_in_ml(carry_ml).with_turned(Some(turned));
            let Ok(plan) = doser.plan(start, &request) else { continue };
            turned = plan.turned_after(plan.steps().unsigned_abs());
            carry_ml = plan.carry_ml();
            planned_ml += plan.planned_ml();
            // The carry never exceeds half a step, however many doses there were.
            prop_assert!(carry_ml.abs() <= 0.5 * 4.4 * plan.step_rad() + 1e-9);
        }
        let curve = pump.outlet_curve();
        let sum_ml = curve.volume_ml(angle_rad + turned.least_rad) - curve.volume_ml(angle_rad);
        prop_assert!((planned_ml - sum_ml).abs() < 1e-9, "{planned_ml} {sum_ml}");
        prop_assert!((turned.middle_ml(&pump) - sum_ml).abs() < 1e-9);
        let (least_ml, most_ml) = turned.range_ml(&pump);
        let within_ml = turned.half_width_ml(&pump);
        prop_assert!(sum_ml - within_ml <= least_ml + 1e-9 && most_ml <= sum_ml + within_ml + 1e-9);
    }

    #[test]
    fn a_known_angle_gives_the_bits_of_the_nearest_step(
        rollers in 2u32..=3,
        volume in any_volume(),
        carry_in_ml in -0.005..0.005_f64,
        start in -7.0..7.0_f64,
    ) {
        let pump = pump(rollers);
        let curve = pump.outlet_curve();
        let request = Request::new(volume, FLOW).with_carry_in_ml(carry_in_ml);
        let plan = Doser::new(&pump, limits(12_800.0)).unwrap().plan(Phase::known(start), &request).unwrap();
        let (start_ml, owed_ml) = (curve.volume_ml(start), volume + carry_in_ml);
        let delivered = |steps: f64| curve.volume_ml(start + steps * plan.step_rad()) - start_ml;
        let below = ((curve.angle_rad(start_ml + owed_ml) - start) / plan.step_rad()).floor();
        let (low_ml, high_ml) = (delivered(below), delivered(below + 1.0));
        let (steps, planned_ml) =
            if owed_ml - low_ml <= high_ml - owed_ml { (below, low_ml) } else { (below + 1.0, high_ml) };
        prop_assert_eq!(plan.steps(), steps as i64);
        for ml in [plan.planned_ml(), plan.least_ml(), plan.most_ml()] {
            prop_assert_eq!(ml.to_bits(), planned_ml.to_bits());
        }
        prop_assert_eq!(plan.carry_ml().to_bits(), (owed_ml - planned_ml).to_bits());
    }
}

#[test]
fn whole_pitches_are_exact_at_any_angle() {
    for rollers in 2..=3 {
        let pump = pump(rollers);
        for pitches in [1.0, 2.0, 3.0, 7.0, -2.0] {
            let volume_ml = pitches * pump.outlet_curve().pitch_ml();
            let request = Request::new(volume_ml, FLOW);
            // A pitch is a whole number of steps.
            let unknown = Phase::unknown(pump.pitch_rad());
            let plan = Doser::new(&pump, limits(12_000.0)).unwrap().plan(unknown, &request).unwrap();
            assert_eq!(plan.steps() as f64, pitches * 12_000.0 / f64::from(rollers));
            assert!(plan.most_ml() - plan.least_ml() < 1e-12 && plan.carry_ml().abs() < 1e-12, "{plan:?}");
        }
    }
}

/// Volumes of the three-roller pump at an unknown angle, mL: (asked for, smallest, largest).
const KNOWN_RANGES: [(f64, f64, f64); 3] =
    [(25.0, 23.9477, 26.0531), (5.0, 3.9850, 6.0165), (0.5, 0.1038, 0.8960)];

#[test]
fn an_unknown_angle_costs_what_is_known() {
    let pump = pump(3);
    for (volume_ml, least_ml, most_ml) in KNOWN_RANGES {
        let plan = planned(&pump, Phase::unknown(pump.pitch_rad()), volume_ml);
        let near = |found: f64, expected: f64| (found - expected).abs() < 5e-4;
        assert!(near(plan.least_ml(), least_ml) && near(plan.most_ml(), most_ml), "{plan:?}");
    }
}

#[test]
fn a_dose_that_no_angle_makes_a_step_of_is_refused_with_the_smallest_that_can_be_had() {
    let pump = pump(3);
    let dose = |volume_ml| {
        Doser::new(&pump, limits(12_800.0))
            .and_then(|doser| doser.plan(Phase::unknown(pump.pitch_rad()), &Request::new(volume_ml, FLOW)))
    };
    for sign in [1.0, -1.0] {
        let Err(PlanError::LessThanHalfAStep { smallest_ml, .. }) = dose(sign * 1e-5) else {
            panic!("too small a dose was planned");
        };
        assert_eq!(dose(smallest_ml * (1.0 + 1e-9)).unwrap().steps(), sign as i64);
        assert!(dose(smallest_ml * (1.0 - 1e-9)).is_err());
    }
}

#[test]
fn a_dose_from_an_unknown_angle_can_be_changed_and_stopped() {
    let pump = pump(3);
    let whole = planned(&pump, Phase::unknown(pump.pitch_rad()), 25.0);
    let rest = Doser::new(&pump, limits(12_800.0))
        .unwrap()
        .retarget(&whole, &Retarget::new(6000, 30.0, FLOW))
        .unwrap();
    let total_ml = whole.delivered_ml(&pump, 6000) + rest.planned_ml() + rest.carry_ml();
    assert!((total_ml - 30.0).abs() < 1e-9 && rest.carry_ml().abs() < 2e-3);
    assert!(!rest.start().is_known(pump.pitch_rad()));
    let stop = whole.stop(&pump, 6000).unwrap();
    assert_eq!((stop.least_ml(), stop.most_ml()), stop.range_ml(&pump, stop.steps().unsigned_abs()));
}

#[test]
fn a_change_to_the_volume_that_was_offered_is_not_refused() {
    let pump = pump(3);
    let limits = limits(12_800.0);
    for volume_ml in [10.0, 12.0, 14.2, 17.0] {
        let whole = planned(&pump, Phase::unknown(pump.pitch_rad()), volume_ml);
        for made in [1500, 3000, 4500] {
            let refused = Doser::new(&pump, limits)
                .and_then(|doser| doser.retarget(&whole, &Retarget::new(made, 0.1, FLOW)))
                .unwrap_err();
            let PlanError::CannotStopThere { nearest_ml, .. } = refused else { panic!("{refused}") };
            let rest = Doser::new(&pump, limits)
                .unwrap()
                .retarget(&whole, &Retarget::new(made, nearest_ml, FLOW))
                .unwrap();
            let total_ml = whole.delivered_ml(&pump, made) + rest.planned_ml();
            assert!((total_ml - nearest_ml).abs() < 1e-9, "{volume_ml} mL after {made}");
        }
    }
}
