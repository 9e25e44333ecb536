//! The pins of a driver: their levels and their times.

use proptest::prelude::*;
use pump_ctl::drive::{Fault, OnFault, Pin, StepDir, StepMotor, Timing};
use pump_ctl::step::{Direction, Segment};

use super::wires::{Bench, Event};
use super::{deadlines, dose, idle, on_pins, start, there_and_back, turn, turn_on_time};

fn any_timing() -> impl Strategy<Value = Timing> {
    let step = (0..30_000_u32, 0..30_000_u32);
    let direction = (0..60_000_u32, 0..60_000_u32);
    (step, direction, 0..2_000_000_u32, any::<[bool; 3]>()).prop_map(
        |((high, low), (setup, hold), enable, [enable_low, reversed, index_low])| {
            Timing::new()
                .with_step_high_ns(high)
                .with_step_low_ns(low)
                .with_direction_setup_ns(setup)
                .with_direction_hold_ns(hold)
                .with_enable_setup_ns(enable)
                .with_enable_active_low(enable_low)
                .with_reversed(reversed)
                .with_index_active_low(index_low)
        },
    )
}

/// Returns the time since the last event of `pin` before the `n`-th, ns, or `None` if there is no such event.
fn since(log: &[Event], n: usize, pin: Pin) -> Option<u64> {
    let before = log[..n].iter().rev().find(|event| event.pin == pin)?;
    Some(log[n].at_ns - before.at_ns)
}

/// Checks that every event keeps the times that the driver needs, and that the pins it needs are set.
fn check_times(log: &[Event], timing: &Timing) {
    for (n, event) in log.iter().enumerate() {
        let since = |pin| since(log, n, pin);
        match (event.pin, event.high) {
            (Pin::Step, true) => {
                assert!(since(Pin::Enable).unwrap() >= u64::from(timing.enable_setup_ns), "enable, {n}");
                assert!(
                    since(Pin::Direction).unwrap() >= u64::from(timing.direction_setup_ns),
                    "set-up, {n}"
                );
                assert!(since(Pin::Step).unwrap() >= u64::from(timing.step_low_ns), "low, {n}");
            }
            (Pin::Step, false) => {
                assert!(since(Pin::Step).is_none_or(|ns| ns >= u64::from(timing.step_high_ns)), "high, {n}");
            }
            (Pin::Direction, _) => {
                assert!(since(Pin::Step).unwrap() >= u64::from(timing.direction_hold_ns), "hold, {n}");
            }
            _ => {}
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    #[test]
    fn a_dose_that_turns_round_keeps_the_drivers_times_at_every_step(timing in any_timing()) {
        let (ahead, back) = (dose(0.2, 5.0).steps(), dose(-0.1, 5.0).steps());
        prop_assert!(ahead > 50 && back < -50, "{ahead} {back}");
        let due = deadlines(there_and_back(0.2), 0);
        // Every other call is so late that the next step is due a moment after, the first step back included.
        let late = |n: u64| match due.get(n as usize) {
            Some(next) if n as i64 % 2 == ahead % 2 => next - due[n as usize - 1] - 5,
            _ => 0,
        };
        let bench = Bench::default();
        let mut actuator = on_pins::<256>(&bench, timing, OnFault::Hold);
        let first = start(&mut actuator, &bench, there_and_back(0.2)).unwrap();
        prop_assert_eq!(turn(&mut actuator, &bench, first, late), Ok(()));
        prop_assert_eq!(actuator.stepper().position(), ahead + back);
        prop_assert_eq!(bench.steps_ns().len() as i64, ahead - back);
        check_times(&bench.state().log, &timing);
    }

    #[test]
    fn polarity_is_as_wired(timing in any_timing()) {
        let bench = Bench::default();
        let mut actuator = on_pins::<256>(&bench, timing, OnFault::Hold);
        prop_assert_eq!(bench.state().level(Pin::Enable), Some(!timing.enable_active_low));
        let due = start(&mut actuator, &bench, there_and_back(0.2)).unwrap();
        prop_assert_eq!(turn_on_time(&mut actuator, &bench, due), Ok(()));
        let forward = if timing.reversed { -1 } else { 1 };
        prop_assert_eq!(bench.state().rotor, forward * actuator.stepper().position());
        prop_assert_eq!(actuator.disable(), Ok(()));
        prop_assert_eq!(bench.state().level(Pin::Enable), Some(timing.enable_active_low));
        bench.state().sensor = Some(i64::MIN..i64::MAX);
        prop_assert_eq!(actuator.motor().index(), Ok(Some(!timing.index_active_low)));
    }
}

/// Ten steps forward.
const AHEAD: Segment = Segment { count: 10, interval: 500, add: 0, frac: 0 };

#[test]
fn nothing_moves_before_the_motor_is_enabled() {
    let bench = Bench::default();
    let mut actuator = idle::<4>(&bench, Timing::default(), OnFault::Hold);
    assert_eq!(start(&mut actuator, &bench, [AHEAD]), Err(Fault::NotEnabled));
    assert_eq!(turn_on_time(&mut actuator, &bench, 0), Ok(()));
    assert_eq!(bench.state().log, []);

    actuator.enable().unwrap();
    let due = actuator.start(bench.tick()).unwrap();
    turn_on_time(&mut actuator, &bench, due).unwrap();
    assert_eq!(actuator.stepper().position(), 10);
    actuator.disable().unwrap();
    assert!(actuator.stepper().clear());
    assert_eq!(start(&mut actuator, &bench, [AHEAD]), Err(Fault::NotEnabled));
}

#[test]
fn the_direction_pin_is_set_only_where_the_motor_turns_round() {
    let bench = Bench::default();
    let mut actuator = on_pins::<8>(&bench, Timing::default(), OnFault::Hold);
    let back = Segment { count: -10, ..AHEAD };
    for _ in 0..2 {
        let due = start(&mut actuator, &bench, [AHEAD, AHEAD, back]).unwrap();
        turn_on_time(&mut actuator, &bench, due).unwrap();
    }
    let log = bench.state().log.clone();
    let set: Vec<_> =
        log.iter().filter(|event| event.pin == Pin::Direction).map(|event| event.high).collect();
    assert_eq!(set, [true, false, true, false]);
}

#[test]
fn a_pin_that_is_not_wired_may_stay_away() {
    use pump_ctl::drive::NoPin;
    let bench = Bench::default();
    let [step, direction, ..] = bench.wires();
    let mut driver = StepDir::new(step, direction, NoPin, bench.clone(), Timing::default());
    assert_eq!(driver.enable(), Ok(()));
    assert_eq!(driver.step(Direction::Forward), Ok(()));
    assert_eq!(driver.index(), Ok(None));
    assert_eq!(bench.state().rotor, 1);
}

#[test]
fn letting_go_of_a_moving_motor_stops_it_dead_with_the_count_right() {
    let bench = Bench::default();
    let mut actuator = on_pins::<4>(&bench, Timing::default(), OnFault::Hold);
    let mut due = start(&mut actuator, &bench, [AHEAD]).unwrap();
    for _ in 0..4 {
        bench.wait_until(due);
        let pump_ctl::drive::Timer::At(next) = actuator.on_timer(due).unwrap() else { unreachable!() };
        due = next;
    }
    actuator.disable().unwrap();
    assert_eq!(turn_on_time(&mut actuator, &bench, due), Ok(()));
    assert_eq!((actuator.stepper().position(), bench.state().rotor), (4, 4));
}
