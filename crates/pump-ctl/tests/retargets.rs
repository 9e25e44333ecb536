//! Claims about doses whose volume or rate is changed while the rotor turns.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use proptest::prelude::*;
use pump_ctl::plan::{Cruise, Doser, Limits, Motor, Phase, Plan, PlanError, Request, Retarget};
use pump_ctl::step::{Action, Stepper, TickRate};
use pump_model::{ExactRun, Leg, Port, Pump};

const TICK_RATE: TickRate = TickRate::from_hz(1_000_000).unwrap();
const MOTOR: Motor = Motor::new(12_800.0, 17.8, 500.0);

fn limits() -> Limits {
    Limits::new(MOTOR)
}

fn dose(volume_ml: f64, start_rad: f64, flow_ml_s: f64) -> Plan {
    let request = Request::new(volume_ml, Cruise::Flow { ml_s: flow_ml_s });
    Doser::new(&Pump::three_roller(), limits()).unwrap().plan(Phase::known(start_rad), &request).unwrap()
}

fn changed(whole: &Plan, change: Retarget) -> Result<Plan, PlanError> {
    Doser::new(&Pump::three_roller(), limits())?.retarget(whole, &change)
}

/// Returns the legs of `whole` up to the moment at which `made` steps are made, then those of `rest`.
fn joined(whole: &Plan, made: u64, rest: &Plan) -> Vec<Leg> {
    let changed_s = whole.profile().time_of(made as f64 * whole.step_rad());
    let before = whole.legs().filter(|leg| leg.start_s < changed_s);
    let before = before.map(|leg| Leg { duration_s: leg.duration_s.min(changed_s - leg.start_s), ..leg });
    let after = rest.legs().map(|leg| Leg { start_s: leg.start_s + changed_s, ..leg });
    before.chain(after).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, ..ProptestConfig::default() })]

    #[test]
    fn a_changed_dose_lands_within_half_a_step_of_the_new_volume(
        volume in 5.0..50.0_f64,
        reverse in any::<bool>(),
        start in 0.0..6.2_f64,
        flow in 1.0..12.0_f64,
        part in 0.0..1.0_f64,
        new_volume in 5.0..100.0_f64,
        new_flow in 1.0..12.0_f64,
    ) {
        let pump = Pump::three_roller();
        let sign = if reverse { -1.0 } else { 1.0 };
        let whole = dose(sign * volume, start, flow);
        let made = (part * whole.steps().unsigned_abs() as f64) as u64;
        let delivered = whole.delivered_ml(&pump, made);
        match changed(&whole, Retarget::new(made, sign * new_volume, Cruise::Flow { ml_s: new_flow })) {
            Ok(rest) => {
                let total = delivered + rest.planned_ml();
                prop_assert!((total + rest.carry_ml() - sign * new_volume).abs() < 1e-9);
                prop_assert!(rest.carry_ml().abs() <= 0.5 * rest.end_step_ml(&pump) + 1e-4);
                prop_assert!((total - (pump.outlet_curve().volume_ml(rest.end_angle_rad())
                    - pump.outlet_curve().volume_ml(start))).abs() < 1e-9);
                // The speed goes on without a jump, and ends at rest.
                prop_assert!((rest.speed_after(0) - whole.speed_after(made)).abs() < 1e-9);
                prop_assert!((rest.speed_at(0.0).abs() - rest.speed_after(0)).abs() < 1e-9);
                prop_assert!(rest.profile().acceleration_rad_s2() <= MOTOR.max_acceleration_rad_s2);
                let end = rest.legs().last().unwrap();
                prop_assert!(end.speed_at(end.end_s()).abs() < 1e-6);
            }
            Err(PlanError::CannotStopThere { nearest_ml, .. }) => {
                prop_assert!(sign * nearest_ml > new_volume - 0.01, "{nearest_ml} {new_volume}");
                // A request for the volume that the message offers is accepted.
                changed(&whole, Retarget::new(made, nearest_ml, Cruise::Flow { ml_s: new_flow })).unwrap();
            }
            Err(other) => return Err(TestCaseError::fail(other.to_string())),
        }
    }

    #[test]
    fn the_pressures_of_a_changed_dose_start_from_the_lines_as_they_are(
        part in 0.001..0.9_f64,
        new_flow in 1.0..12.0_f64,
    ) {
        let pump = Pump::three_roller();
        let whole = dose(10.0, 0.3, 8.0);
        let made = (part * whole.steps() as f64) as u64;
        let rest = changed(&whole, Retarget::new(made, 20.0, Cruise::Flow { ml_s: new_flow })).unwrap();
        let changed_s = whole.profile().time_of(made as f64 * whole.step_rad());
        let predicted = rest.predict(&pump).unwrap();
        for (port, range) in [(Port::Inlet, predicted.inlet), (Port::Outlet, predicted.outlet)] {
            let mut run = ExactRun::from_rest(&pump, port, joined(&whole, made, &rest));
            run.at(changed_s);
            let expected = run.extremes(changed_s + rest.profile().duration_s() + 0.5);
            prop_assert!((range.min_kpa - expected.min_kpa).abs() < 1e-6);
            prop_assert!((range.max_kpa - expected.max_kpa).abs() < 1e-6);
        }
    }

    #[test]
    fn the_executor_goes_over_to_the_new_plan_without_a_jump(
        part in 0.0..0.8_f64,
        new_volume in 15.0..30.0_f64,
        new_flow in 1.0..12.0_f64,
    ) {
        let whole = dose(10.0, 0.3, 8.0);
        let mut stepper = Stepper::<64>::new(MOTOR.brake(TICK_RATE).unwrap());
        stepper.fill(&mut whole.segments(TICK_RATE).feed()).unwrap();
        let mut due = stepper.start(0).unwrap();
        let before = (part * whole.steps() as f64) as i64;
        while stepper.position() < before && let Action::Step { next, .. } = stepper.on_deadline(due) {
            due = next;
        }
        // Planning the rest may take ten milliseconds.
        let junction = stepper.retarget(due + 10_000).unwrap();
        let made = junction.position.unsigned_abs();
        let cruise = Cruise::Flow { ml_s: new_flow };
        let rest = changed(&whole, Retarget::new(made, new_volume, cruise)).unwrap();
        prop_assert!((junction.interval as f64 * rest.speed_after(0) / rest.step_rad() / 1e6 - 1.0).abs() < 0.2);
        let mut segments = rest.segments(TICK_RATE).feed();
        stepper.fill(&mut segments).unwrap();
        let mut late = Vec::new();
        while let Action::Step { next, .. } = stepper.on_deadline(due) {
            late.push(due);
            due = next;
            stepper.fill(&mut segments).unwrap();
        }
        prop_assert_eq!(stepper.position(), junction.position + rest.steps());
        let after = late.iter().filter(|at| **at > junction.at);
        for (at, step) in after.zip(rest.each_step()) {
            prop_assert!(((at - junction.at) as f64 - 1e6 * step.time_s).abs() <= 2.0);
        }
    }
}

#[test]
fn a_dose_changed_twice_has_the_volume_that_was_said_last() {
    let pump = Pump::three_roller();
    let cruise = Cruise::Flow { ml_s: 5.0 };
    let whole = dose(25.0, 0.3, 5.0);
    let once = changed(&whole, Retarget::new(6000, 30.0, cruise)).unwrap();
    let twice = changed(&once, Retarget::new(2000, 28.0, cruise)).unwrap();
    let total_ml = whole.delivered_ml(&pump, 6000) + once.delivered_ml(&pump, 2000) + twice.planned_ml();
    assert!((total_ml - 28.0).abs() < 1e-3, "{total_ml}");
    assert!((twice.before_ml() + twice.planned_ml() - total_ml).abs() < 1e-9);
    // The lines are those of the whole motion.
    let changed_s = once.profile().time_of(2000.0 * once.step_rad());
    let mut legs = joined(&whole, 6000, &once);
    let begins_s = legs[legs.len() - once.legs().count()].start_s;
    legs.retain(|leg| leg.start_s < begins_s + changed_s);
    let last = legs.last_mut().unwrap();
    last.duration_s = begins_s + changed_s - last.start_s;
    legs.extend(twice.legs().map(|leg| Leg { start_s: leg.start_s + begins_s + changed_s, ..leg }));
    let mut run = ExactRun::from_rest(&pump, Port::Outlet, legs);
    run.at(begins_s + changed_s);
    let expected = run.extremes(begins_s + changed_s + twice.profile().duration_s() + 0.5);
    let predicted = twice.predict(&pump).unwrap().outlet;
    assert!((predicted.max_kpa - expected.max_kpa).abs() < 1e-6, "{predicted:?} {expected:?}");
    assert!((predicted.min_kpa - expected.min_kpa).abs() < 1e-6, "{predicted:?} {expected:?}");
}

#[test]
fn a_change_that_cannot_be_is_refused_for_what_it_is() {
    let pump = Pump::three_roller();
    let cruise = Cruise::Flow { ml_s: 5.0 };
    let mut fine = limits();
    fine.motor.steps_per_rev = 1e6;
    let whole =
        Doser::new(&pump, fine).unwrap().plan(Phase::known(0.3), &Request::new(10.0, cruise)).unwrap();
    let too_many =
        Doser::new(&pump, fine).and_then(|doser| doser.retarget(&whole, &Retarget::new(1000, 9e4, cruise)));
    assert!(matches!(too_many, Err(PlanError::TooManySteps { .. })), "{too_many:?}");
    let other = changed(&whole, Retarget::new(1000, 9.0, cruise));
    assert!(matches!(other, Err(PlanError::OutOfRange { .. })), "{other:?}");
}

#[test]
fn a_dose_at_its_end_cannot_be_changed() {
    let whole = dose(10.0, 0.3, 8.0);
    let steps = whole.steps().unsigned_abs();
    let changed = changed(&whole, Retarget::new(steps, 20.0, Cruise::Flow { ml_s: 5.0 }));
    assert_eq!(changed, Err(PlanError::NoSuchStep { made: steps, steps }));
}
