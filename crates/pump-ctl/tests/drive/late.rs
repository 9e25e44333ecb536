//! Calls that come late, and queues that run dry.

use proptest::prelude::*;
use pump_ctl::drive::{Fault, OnFault, Timer, Timing};
use pump_ctl::step::{Segment, StartError};

use super::wires::Bench;
use super::{MOTOR, OnPins, TICK_RATE, deadlines, dose, on_pins, start, turn, turn_on_time};

const TICK_NS: u64 = 1000;

/// Starts a dose of 2.5 mL at 5 mL/s, with a step every 333 us in the cruise. Returns the motor, the first
/// deadline and the number of steps.
fn started(bench: &Bench) -> (OnPins<256>, u64, i64) {
    let plan = dose(2.5, 5.0);
    let mut actuator = on_pins(bench, Timing::default(), OnFault::Hold);
    let due = start(&mut actuator, bench, plan.segments(TICK_RATE)).unwrap();
    (actuator, due, plan.steps())
}

/// Returns the deadlines of a dose of 2.5 mL at 5 mL/s, ticks since the start.
fn punctual() -> Vec<u64> {
    deadlines(dose(2.5, 5.0).segments(TICK_RATE), 0)
}

/// Returns the steps that the steepest stop needs from a speed of one step every `interval` ticks.
fn shortest_stop(interval: u64) -> f64 {
    let speed_rad_s = f64::from(TICK_RATE.hz()) / interval as f64 * MOTOR.step_rad();
    speed_rad_s * speed_rad_s / (2.0 * MOTOR.max_acceleration_rad_s2) / MOTOR.step_rad()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    #[test]
    fn calls_late_by_less_than_an_interval_shift_no_other_step(seed in any::<u64>()) {
        let expected = punctual();
        let shortest = expected.windows(2).map(|pair| pair[1] - pair[0]).min().unwrap();
        let bench = Bench::default();
        let (mut actuator, due, steps) = started(&bench);
        let began = bench.tick();
        // The pulse of the step before takes its time.
        let lateness = |n: u64| n.wrapping_mul(seed | 1) % (shortest - 5);
        prop_assert_eq!(turn(&mut actuator, &bench, due, lateness), Ok(()));
        prop_assert_eq!(actuator.stepper().position(), steps);
        let made = bench.steps_ns();
        prop_assert_eq!(made.len(), expected.len());
        // The direction pin is set before the first step.
        for (n, (at_ns, due)) in (1..).zip(made.iter().zip(&expected)).skip(1) {
            prop_assert_eq!(at_ns / TICK_NS - began, due + lateness(n));
        }
    }

    #[test]
    fn a_call_late_by_more_than_an_interval_decelerates_without_a_burst(
        part in 0.0..1.0_f64,
        more in 1..100_000_u64,
    ) {
        let expected = punctual();
        let at = (part * (expected.len() - 2) as f64) as u64 + 1;
        let interval = expected[at as usize] - expected[at as usize - 1];
        let late = interval + more;
        let bench = Bench::default();
        let (mut actuator, due, steps) = started(&bench);
        let end = turn(&mut actuator, &bench, due, |n| if n == at { late } else { 0 });
        let position = bench.state().rotor;
        prop_assert_eq!(end, Err(Fault::Late { late_ticks: late, position }));
        prop_assert_eq!(actuator.stepper().position(), position);
        prop_assert!(position >= at as i64 && position <= steps);
        // The motor stops as soon as the brake allows, and no step comes sooner than the speed before allows.
        prop_assert!((position - at as i64) as f64 <= 2.0 * shortest_stop(interval) + 3.0);
        for gap in &bench.gaps_ns()[at as usize - 1..] {
            prop_assert!(gap / TICK_NS + 1 >= interval, "{gap} ns after intervals of {interval} ticks");
        }
        // The motor stands, and stays so until it is cleared.
        prop_assert_eq!(actuator.start(bench.tick()), Err(Fault::Start(StartError::Stopped)));
        prop_assert_eq!(bench.steps_ns().len() as i64, position);
    }

    #[test]
    fn calls_that_are_late_again_on_the_way_down_make_no_burst_either(
        part in 0.0..1.0_f64,
        late in prop::collection::vec(2000..100_000_u64, 2..5),
    ) {
        let expected = punctual();
        let at = (part * (expected.len() - 2) as f64) as usize + 1;
        let interval = expected[at] - expected[at - 1];
        let bench = Bench::default();
        let (mut actuator, mut due, _) = started(&bench);
        let mut calls = Vec::new();
        let end = loop {
            let late = calls.len().checked_sub(at - 1).and_then(|n| late.get(n)).copied().unwrap_or(0);
            bench.wait_until(due + late);
            let now = bench.tick();
            let next = actuator.on_timer(now);
            calls.push((now, late, actuator.stepper().position()));
            match next {
                Ok(Timer::At(next)) => due = next,
                end => break end,
            }
        };
        let position = bench.state().rotor;
        prop_assert_eq!(end, Err(Fault::Late { late_ticks: late[0], position }));
        for gap in &bench.gaps_ns()[at - 1..] {
            prop_assert!(gap / TICK_NS + 1 >= interval, "{gap} ns after intervals of {interval} ticks");
        }
        // Steps that were put off are no part of the past.
        for (now, late, position) in calls {
            for t in [now, now - late.min(1)] {
                prop_assert_eq!(actuator.stepper().position_at(t), Some(position));
            }
        }
    }

    #[test]
    fn a_queue_that_runs_dry_decelerates_and_says_so(keep in 1_usize..20) {
        let segments: Vec<_> = dose(25.0, 5.0).segments(TICK_RATE).take(keep).collect();
        let fed: i64 = segments.iter().map(|segment| i64::from(segment.count)).sum();
        let bench = Bench::default();
        let mut actuator = on_pins::<32>(&bench, Timing::default(), OnFault::Hold);
        for segment in segments {
            actuator.stepper().push(segment, TICK_RATE).unwrap();
        }
        let due = actuator.start(bench.tick()).unwrap();
        let end = turn_on_time(&mut actuator, &bench, due);
        let position = bench.state().rotor;
        prop_assert_eq!(end, Err(Fault::Starved { position }));
        prop_assert_eq!(actuator.stepper().position(), position);
        let gaps = bench.gaps_ns();
        let interval = gaps[fed as usize - 2] / TICK_NS;
        prop_assert!((position - fed) as f64 <= 2.0 * shortest_stop(interval) + 3.0);
        let slows = gaps[fed as usize - 2..].windows(2).all(|pair| pair[1] + 2 * TICK_NS >= pair[0]);
        prop_assert!(slows && (position > fed || interval > 5000));
        // The executor reports the stop until it is cleared.
        prop_assert_eq!(turn_on_time(&mut actuator, &bench, 0), Err(Fault::Starved { position }));
        prop_assert!(actuator.stepper().clear());
        prop_assert_eq!(actuator.on_timer(bench.tick()), Ok(Timer::Done));
    }
}

#[test]
fn a_refused_start_does_not_hide_that_a_call_was_late() {
    let bench = Bench::default();
    let (mut actuator, due, _) = started(&bench);
    bench.wait_until(due + 50_000);
    let Timer::At(due) = actuator.on_timer(bench.tick()).unwrap() else { unreachable!() };
    assert_eq!(actuator.start(bench.tick()), Err(Fault::Start(StartError::Moving)));
    let end = turn_on_time(&mut actuator, &bench, due);
    assert!(matches!(end, Err(Fault::Late { late_ticks: 50_000, .. })), "{end:?}");
}

#[test]
fn a_new_move_after_a_late_one_is_not_late() {
    let bench = Bench::default();
    let (mut actuator, due, steps) = started(&bench);
    let end = turn(&mut actuator, &bench, due, |n| if n == 500 { 50_000 } else { 0 });
    let Err(Fault::Late { position, .. }) = end else { unreachable!("{end:?}") };
    assert!(actuator.stepper().clear());
    let due = start(&mut actuator, &bench, dose(2.5, 5.0).segments(TICK_RATE)).unwrap();
    assert_eq!(turn_on_time(&mut actuator, &bench, due), Ok(()));
    assert_eq!(actuator.stepper().position(), position + steps);
}

#[test]
fn a_full_queue_makes_room_for_what_is_put_off() {
    let bench = Bench::default();
    let mut actuator = on_pins::<3>(&bench, Timing::default(), OnFault::Hold);
    let even = |count, interval| Segment { count, interval, add: 0, frac: 0 };
    let due = start(&mut actuator, &bench, [even(10, 500), even(1, 700), even(1, 1500)]).unwrap();
    let end = turn(&mut actuator, &bench, due, |n| if n == 9 { 10_000 } else { 0 });
    assert_eq!(end, Err(Fault::Late { late_ticks: 10_000, position: 12 }));
    assert_eq!(bench.gaps_ns()[7..], [10_500_000, 500_000, 700_000, 1_500_000]);
    let now = bench.tick();
    assert_eq!(actuator.stepper().position_at(now), Some(12));
    assert_eq!(actuator.stepper().position_at(now - 2000), Some(10));
}
