//! Flows that cannot be met are refused, with the row or the first instant and its value.

use pump_ctl::plan::{FlowError, FlowPlan, FlowRow, Motor, Phase};
use pump_model::Pump;

use crate::heads::Head;
use crate::{STEP_RAD, motor, rows, steps};

/// Returns the refusal of rows from angle 0.
fn refusal(of: &[(f64, f64)]) -> FlowError {
    steps(&Pump::three_roller(), 0.0, &rows(of)).unwrap_err()
}

#[test]
fn a_bad_row_is_named_with_its_value() {
    for (of, words) in [
        (&[(1.0, 0.0), (2.0, 1.0)][..], "row 1 has the time 1 s"),
        (&[(-1.0, 0.0)], "row 1 has the time -1 s"),
        (&[(0.0, 0.0), (f64::NAN, 1.0)], "row 2 has the time NaN s"),
        (&[(0.0, 0.0), (f64::INFINITY, 1.0)], "row 2 has the time inf s"),
        (&[(0.0, 0.0), (2.0, 1.0), (1.5, 1.0)], "row 3 has the time 1.5 s after 2 s"),
        (&[(0.0, 0.0), (2.0, f64::NAN)], "row 2 has the flow NaN mL/s"),
        (&[(0.0, 0.0), (2.0, f64::NEG_INFINITY)], "row 2 has the flow -inf mL/s"),
        (&[(0.0, 0.0), (2.0, 1.0), (4.0, -1.0)], "row 3 has the flow -1 mL/s against"),
        (&[], "rows of this one: 0"),
        (&[(0.0, 0.0)], "rows of this one: 1"),
        (&[(0.0, 0.0), (9.0, 0.0)], "rows of this one: 2"),
        (&[(0.0, 0.0), (1e300, 1e-3), (1e300, 0.0)], "more than 1e9 motor steps by"),
        (&[(0.0, 0.0), (1e300, 1e300)], "more than 1e9 motor steps by"),
        (&[(0.0, 0.1), (1e9, 0.1)], "more than 1e9 motor steps by 1000000000"),
    ] {
        let message = refusal(of).to_string();
        assert!(message.contains(words), "{of:?}: {message}");
    }
}

#[test]
fn a_flow_that_grows_too_fast_is_refused_at_the_first_instant_that_the_motor_cannot_meet() {
    let pump = Pump::three_roller();
    let brisk = motor().with_max_acceleration_rad_s2(1e6);
    let mut plan = FlowPlan::new(&pump, brisk, Phase::known(0.0)).unwrap();
    plan.take(FlowRow::new(0.0, 0.0)).unwrap();
    let refused = plan.take(FlowRow::new(100.0, 100.0)).unwrap_err();
    let FlowError::TooFast { row, time_s, needed_rpm, limit_rpm } = refused else { panic!("{refused}") };
    assert_eq!((row, limit_rpm.round()), (2, 170.0));
    assert!(needed_rpm > limit_rpm && needed_rpm < 1.01 * limit_rpm, "{needed_rpm}");
    // The angle follows theta' = q/f(theta); Heun's rule finds the first instant by itself.
    let speed = |t_s: f64, angle_rad: f64| t_s / pump.outlet_curve().flow_ml_rad(angle_rad);
    let (mut t_s, mut angle_rad, tick_s) = (0.0, 0.0, 1e-4);
    while speed(t_s, angle_rad) <= motor().max_speed_rad_s {
        let first = speed(t_s, angle_rad);
        let second = speed(t_s + tick_s, angle_rad + tick_s * first);
        angle_rad += 0.5 * tick_s * (first + second);
        t_s += tick_s;
    }
    assert!((time_s - t_s).abs() < 2e-3, "{time_s} {t_s}");
}

#[test]
fn a_flow_that_needs_more_acceleration_than_the_motor_has_is_refused() {
    let slow = motor().with_max_acceleration_rad_s2(2.0);
    let pump = Pump::three_roller();
    let mut flow = FlowPlan::new(&pump, slow, Phase::known(0.0)).unwrap();
    flow.take(FlowRow::new(0.0, 0.0)).unwrap();
    let refused = flow.take(FlowRow::new(20.0, 20.0)).unwrap_err();
    let FlowError::TooSteep { row, time_s, needed_rad_s2, limit_rad_s2 } = refused else {
        panic!("{refused}")
    };
    assert_eq!((row, limit_rad_s2), (2, 2.0));
    assert!(needed_rad_s2 > 2.0 && (0.0..20.0).contains(&time_s), "{refused}");
    // A refused row is not taken, and another may be.
    assert!(flow.take(FlowRow::new(20.0, 0.2)).is_ok());
    assert!((flow.volume_ml() - 2.0).abs() < 1e-12);
}

#[test]
fn a_step_of_the_flow_may_leave_the_angle_by_one_motor_step() {
    // A rotor of 500 rad/s² is behind a jump by w by w²/(8 * 500) rad. One step of 12,800 a turn is that for:
    let jump_rad_s = (8.0 * 500.0 * STEP_RAD).sqrt();
    let pump = Pump::three_roller();
    let level_rad = 1.2;
    let most_ml_s = jump_rad_s * pump.outlet_curve().flow_ml_rad(level_rad);
    let with = |flow_ml_s: f64| {
        let mut plan = FlowPlan::new(&pump, motor(), Phase::known(level_rad)).unwrap();
        plan.take(FlowRow::new(0.0, flow_ml_s))
    };
    assert!(with(0.999 * most_ml_s).is_ok());
    let refused = with(1.5 * most_ml_s).unwrap_err();
    let FlowError::Step { row, time_s, from_ml_s, off_steps, least_s, .. } = refused else {
        panic!("{refused}")
    };
    assert_eq!((row, time_s, from_ml_s), (1, 0.0, 0.0));
    assert!((off_steps - 2.25).abs() < 1e-9, "{off_steps}");
    assert!((least_s - 1.5 * jump_rad_s / 500.0).abs() < 1e-12);
    // The end is a step to rest.
    let ends = steps(&pump, level_rad, &rows(&[(0.0, 0.0), (0.05, 1.3 * most_ml_s)])).unwrap_err();
    assert!(matches!(ends, FlowError::Step { row: 2, to_ml_s: 0.0, .. }), "{ends}");
}

#[test]
fn heads_whose_flow_reverses_and_angles_that_are_not_known_are_refused() {
    let pump = Head::reference().pump();
    let refused = FlowPlan::new(&pump, motor(), Phase::known(0.0)).unwrap_err();
    assert!(
        matches!(refused, FlowError::Reverses { least_ml_rad } if (least_ml_rad + 0.393_364).abs() < 5e-7)
    );
    let pump = Pump::three_roller();
    for start in [Phase::unknown(pump.pitch_rad()), Phase::within(0.0, 2.0 * STEP_RAD)] {
        let refused = FlowPlan::new(&pump, motor(), start).unwrap_err();
        assert!(matches!(refused, FlowError::UnsureAngle { .. }), "{refused}");
    }
    assert!(FlowPlan::new(&pump, motor(), Phase::within(0.0, 0.9 * STEP_RAD)).is_ok());
    let fast = Motor::new(12_800.0, f64::NAN, 500.0);
    assert!(matches!(FlowPlan::new(&pump, fast, Phase::known(0.0)).unwrap_err(), FlowError::Plan(_)));
}
