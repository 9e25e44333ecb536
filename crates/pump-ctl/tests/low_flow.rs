//! Claims about doses that end where the flow is low.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use proptest::prelude::*;
use pump_ctl::plan::{Cruise, Doser, Finish, Limits, Motor, Phase, Plan, PlanError, Request, Retarget};
use pump_model::{Geometry, Line, Pump, RollerVolume, Variant};

const FLOW: Cruise = Cruise::Flow { ml_s: 5.0 };

fn limits(steps_per_rev: f64) -> Limits {
    Limits::new(Motor::new(steps_per_rev, 17.8, 500.0))
}

fn low(pump: &Pump, start: Phase, volume_ml: f64, carry_in_ml: f64, steps: f64) -> Result<Plan, PlanError> {
    let request = Request::new(volume_ml, FLOW).with_finish(Finish::LowFlow).with_carry_in_ml(carry_in_ml);
    Doser::new(pump, limits(steps)).and_then(|doser| doser.plan(start, &request))
}

fn is_low(pump: &Pump, angle_rad: f64) -> bool {
    // The edge of a stretch is found to the last bits.
    pump.outlet_curve().flow_ml_rad(angle_rad) <= 0.5 * pump.nominal_ml_rad() * (1.0 + 1e-9)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    #[test]
    fn the_end_is_the_allowed_one_nearest_to_what_is_owed(
        two in any::<bool>(),
        reverse in any::<bool>(),
        coarse in any::<bool>(),
        start_rad in -20.0..20.0_f64,
        volume in 0.05..60.0_f64,
        carry_in_ml in -3.0..3.0_f64,
    ) {
        let pump = if two { Pump::two_roller() } else { Pump::three_roller() };
        let steps_per_rev = if coarse { 400.0 } else { 3200.0 };
        let volume = if reverse { -volume } else { volume };
        let owed_ml = volume + carry_in_ml;
        let start = Phase::known(start_rad);
        let curve = pump.outlet_curve();
        let step_rad = core::f64::consts::TAU / steps_per_rev;
        // The search by brute force looks at every allowed end in the direction of the dose.
        let direction = owed_ml.signum();
        let ends = (1..(12.0 * steps_per_rev) as u32).map(|n| start_rad + direction * f64::from(n) * step_rad);
        let off_ml = |rad: f64| (curve.volume_ml(rad) - curve.volume_ml(start_rad) - owed_ml).abs();
        let least_ml = ends.filter(|rad| is_low(&pump, *rad)).map(off_ml).fold(f64::INFINITY, f64::min);
        match low(&pump, start, volume, carry_in_ml, steps_per_rev) {
            Ok(plan) => {
                prop_assert!(is_low(&pump, plan.end_angle_rad()));
                prop_assert!((plan.carry_ml().abs() - least_ml).abs() < 1e-9, "{} {least_ml}", plan.carry_ml());
                prop_assert!((plan.planned_ml() + plan.carry_ml() - owed_ml).abs() < 1e-12);
            }
            Err(PlanError::NoLowFlowEnd { .. }) => prop_assert!(least_ml > owed_ml.abs() - 1e-9),
            Err(PlanError::LessThanHalfAStep { .. }) => prop_assert!(owed_ml.abs() < 4.5 * step_rad),
            Err(other) => prop_assert!(false, "{other}"),
        }
    }
}

#[test]
fn what_is_said_to_carry_nothing_carries_nothing() {
    let pump = Pump::three_roller();
    for volume_ml in [5.0, 25.0, -40.0] {
        let carrying = low(&pump, Phase::known(0.3), volume_ml, 0.4, 12_800.0).unwrap();
        let offered = carrying.low_flow_volumes_ml(&pump).unwrap();
        assert!(offered.iter().flatten().any(|ml| (ml - carrying.planned_ml()).abs() < 1e-12), "{offered:?}");
        for ml in offered.into_iter().flatten() {
            let exact = low(&pump, Phase::known(0.3), ml - 0.4, 0.4, 12_800.0).unwrap();
            assert!(exact.carry_ml().abs() < 1e-9, "{volume_ml}: {exact:?}");
        }
    }
}

#[test]
fn many_doses_that_end_at_low_flow_add_up_and_owe_less_than_a_pitch() {
    let pump = Pump::three_roller();
    let (mut stands, mut carry_ml, mut sum_ml) = (Phase::known(0.3), 0.0, 0.0);
    for dose in 1..=200 {
        let plan = low(&pump, stands, 9.3, carry_ml, 12_800.0).unwrap();
        (stands, carry_ml) = (stands.moved_to(plan.end_angle_rad()), plan.carry_ml());
        sum_ml += plan.planned_ml();
        assert!((sum_ml + carry_ml - 9.3 * f64::from(dose)).abs() < 1e-8);
        assert!(carry_ml.abs() < pump.outlet_curve().pitch_ml(), "{carry_ml}");
    }
}

#[test]
fn steps_at_the_end_are_half_as_coarse_or_less() {
    let pump = Pump::three_roller();
    let plan = low(&pump, Phase::known(0.3), 25.0, 0.0, 12_800.0).unwrap();
    assert!(plan.end_step_ml(&pump) <= 0.5 * pump.nominal_ml_rad() * plan.step_rad() * (1.0 + 1e-9));
}

#[test]
fn an_angle_that_is_not_known_well_enough_is_refused_and_a_narrow_one_ends_low_from_anywhere_in_it() {
    let pump = Pump::three_roller();
    for half_width_rad in [0.4, 0.5 * pump.pitch_rad(), 3.0] {
        let start = Phase::within(0.3, half_width_rad);
        let error = low(&pump, start, 25.0, 0.0, 12_800.0).unwrap_err();
        assert!(matches!(error, PlanError::LowFlowWithoutAngle { .. }), "{error}");
    }
    let start = Phase::within(0.3, 0.02);
    let plan = low(&pump, start, 25.0, 0.0, 12_800.0).unwrap();
    for part in [-1.0, -0.5, 0.0, 0.5, 1.0] {
        assert!(is_low(&pump, plan.end_angle_rad() + part * 0.02), "{part}");
    }
}

#[test]
fn a_pump_whose_flow_never_falls_that_low_is_refused_with_the_reason() {
    // Each roller displaces a third of the measured volume.
    let volume = RollerVolume::measured().unwrap().scaled_to(0.7).unwrap();
    let geometry = Geometry::published(3, Variant::Measured);
    let pump = Pump::new(geometry, volume, Line::PUBLISHED, Line::PUBLISHED).unwrap();
    let error = low(&pump, Phase::known(0.3), 25.0, 0.0, 12_800.0).unwrap_err();
    let PlanError::NoLowFlow { least_ml_rad, limit_ml_rad } = error else { panic!("{error}") };
    assert!(least_ml_rad > limit_ml_rad && (limit_ml_rad - 2.199).abs() < 1e-3, "{error}");
}

#[test]
fn a_changed_volume_ends_at_low_flow_too() {
    let pump = Pump::three_roller();
    let limits = limits(12_800.0);
    let whole = low(&pump, Phase::known(0.3), 25.0, 0.0, 12_800.0).unwrap();
    let rest = Doser::new(&pump, limits).unwrap().retarget(&whole, &Retarget::new(6000, 40.0, FLOW)).unwrap();
    assert_eq!(rest.finish(), Finish::LowFlow);
    assert!(is_low(&pump, rest.end_angle_rad()));
    assert!((whole.delivered_ml(&pump, 6000) + rest.planned_ml() + rest.carry_ml() - 40.0).abs() < 1e-9);
    // It is too late to stop at the end that is nearest to the new volume.
    let now_ml = whole.delivered_ml(&pump, 6000);
    let error = Doser::new(&pump, limits)
        .and_then(|doser| doser.retarget(&whole, &Retarget::new(6000, now_ml + 1e-3, FLOW)))
        .unwrap_err();
    let refused = matches!(error, PlanError::CannotStopThere { .. } | PlanError::NoLowFlowEnd { .. });
    assert!(refused, "{error}");
}
