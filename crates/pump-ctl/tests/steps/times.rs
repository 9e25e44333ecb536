//! The times of steps.

use proptest::prelude::*;
use pump_ctl::plan::{Cruise, Doser, Limits, Motor, Phase, Request};
use pump_ctl::step::{Action, TickRate};

use super::{Case, TURN_RAD, any_case, run};

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, ..ProptestConfig::default() })]

    #[test]
    fn every_step_of_a_dose_comes_within_one_tick_of_the_plan(case in any_case(), start in 0..1_u64 << 50) {
        let mut stepper = case.queued();
        let due = stepper.start(start).unwrap();
        let (made, end) = run(&mut stepper, due);
        prop_assert_eq!(end, Action::Done);
        prop_assert_eq!(stepper.position(), case.plan.steps());
        let planned = case.planned_ticks();
        prop_assert_eq!(made.len(), planned.len());
        for (made, planned) in made.iter().zip(planned) {
            let error = (made - start) as f64 - planned;
            prop_assert!(error.abs() <= 1.0, "{error} ticks at {planned}");
        }
    }

    #[test]
    fn a_late_call_delays_one_step_and_shifts_none_of_the_others(case in any_case(), late in 1_u64..1000) {
        let mut stepper = case.queued();
        let mut due = stepper.start(0).unwrap();
        let mut punctual = case.queued();
        let first = punctual.start(0).unwrap();
        let (expected, _) = run(&mut punctual, first);
        let mut deadlines = Vec::new();
        // Every call is late, by less or more than an interval.
        while let Action::Step { next, .. } = stepper.on_deadline(due + late) {
            deadlines.push(due);
            due = next;
        }
        prop_assert_eq!(deadlines, expected);
    }
}

#[test]
fn steps_come_from_minutes_apart_to_200_000_a_second() {
    // The cases are a step of 0.016 rad every 160 s at 168 MHz, and 200,000 steps a second at 1 MHz.
    let slow = Motor::new(400.0, 1.0, 500.0);
    let fast = Motor::new(1_000_000.0, 1.3, 10.0);
    let fast_rad_s = 200_000.0 / 1_000_000.0 * TURN_RAD;
    for case in
        [Case::new(slow, 168_000_000, 2.0, 0.0, 1e-4), Case::new(fast, 1_000_000, 20.0, 0.0, fast_rad_s)]
    {
        let mut stepper = case.queued();
        let due = stepper.start(7).unwrap();
        let (made, _) = run(&mut stepper, due);
        for (made, planned) in made.iter().zip(case.planned_ticks()) {
            assert!(((made - 7) as f64 - planned).abs() <= 1.0);
        }
        let shortest = made.windows(2).map(|pair| pair[1] - pair[0]).min().unwrap();
        let interval =
            f64::from(case.tick_rate.hz()) * case.plan.step_rad() / case.plan.profile().peak_rad_s();
        assert!((shortest as f64 - interval).abs() <= 1.0, "{shortest} {interval}");
    }
}

#[test]
fn a_dose_at_the_default_rate_needs_few_segments() {
    let motor = Motor::new(12_800.0, 17.8, 500.0);
    let count = |tick_hz| {
        Case::new(motor, tick_hz, 25.0, 0.3, 7.4).plan.segments(TickRate::from_hz(tick_hz).unwrap()).count()
    };
    // The slow steps at the end of line-aware ramps take a segment each.
    assert!(count(1_000_000) <= 110, "{}", count(1_000_000));
    assert!(count(168_000_000) <= 400, "{}", count(168_000_000));
}

#[test]
fn segments_from_the_middle_of_a_smooth_cruise_keep_to_the_times_of_the_plan() {
    let pump = pump_model::Pump::three_roller();
    let limits = Limits::new(Motor::new(12_800.0, 17.8, 500.0));
    let request = Request::new(60.0, Cruise::Flow { ml_s: 4.0 }).with_smooth(true);
    let plan = Doser::new(&pump, limits).unwrap().plan(Phase::known(0.3), &request).unwrap();
    let cruise = plan.cruise_steps();
    assert!(cruise.start > 0 && cruise.end < plan.steps().unsigned_abs());
    let tick_hz = 1_000_000;
    let due = |step: u64| plan.profile().time_of(step as f64 * plan.step_rad()) * f64::from(tick_hz);
    let first = cruise.start.midpoint(cruise.end);
    let (mut made, mut at) = (first, due(first));
    for segment in plan.segments(TickRate::from_hz(tick_hz).unwrap()).after(first) {
        for step in 1..=segment.steps() {
            let ticks = segment.interval_before(step);
            at += ticks.whole as f64 + f64::from(ticks.frac) / 4_294_967_296.0;
            made += 1;
            assert!((at - due(made)).abs() <= 0.3, "step {made}: {at} {}", due(made));
        }
    }
    assert_eq!(made, plan.steps().unsigned_abs());
}
