//! Pins that fail.

use embedded_hal::digital::ErrorKind;
use pump_ctl::drive::{Fault, OnFault, Pin, PinFault, Timing};
use pump_ctl::step::{Segment, StartError};

use super::wires::{Bench, Failure};
use super::{idle, on_pins, start, turn_on_time};

const AHEAD: i64 = 30;

/// Even speed ahead in two segments, then back in two. The move has every kind of boundary between segments.
const MOVE: [Segment; 4] = [even(17), even(AHEAD as i32 - 17), even(-1), even(-19)];

/// Steps of the whole move.
const STEPS: u64 = 50;

const fn even(count: i32) -> Segment {
    Segment { count, interval: 500, add: 0, frac: 0 }
}

/// Returns the position after `made` steps of the move.
fn position_after(made: u64) -> i64 {
    let made = made as i64;
    if made <= AHEAD { made } else { 2 * AHEAD - made }
}

/// Runs the move into `failure`. The motor must stand where `made` steps lead, and must stay there.
fn fails_and_stays(failure: Failure, made: u64, on_fault: OnFault, watch: bool) {
    let bench = Bench::default();
    let mut actuator = on_pins::<8>(&bench, Timing::default(), on_fault);
    let energised = bench.state().level(Pin::Enable);
    if watch {
        actuator.watch_index().unwrap();
    }
    bench.state().failures = vec![failure];
    let due = start(&mut actuator, &bench, MOVE).unwrap();

    let fault = turn_on_time(&mut actuator, &bench, due).unwrap_err();
    let fell = failure.pin == Pin::Step && !failure.high;
    let error = PinFault { pin: failure.pin, kind: ErrorKind::Other, made: fell };
    assert_eq!(fault, Fault::Motor { error, position: position_after(made) }, "{failure:?}");
    assert_eq!(bench.state().rotor, position_after(made), "{failure:?}");
    assert_eq!(actuator.stepper().position(), position_after(made));

    let holds = bench.state().level(Pin::Enable) == energised;
    assert_eq!(holds, on_fault == OnFault::Hold);
    let events = bench.state().log.len();
    let later = bench.tick() + 10_000_000;
    assert_eq!(turn_on_time(&mut actuator, &bench, later), Ok(()));
    let again = actuator.start(later).unwrap_err();
    assert_eq!(again, if holds { Fault::Start(StartError::Stopped) } else { Fault::NotEnabled });
    assert_eq!(bench.state().log.len(), events, "something moved");
}

/// A pin fails at every step in turn, with both ways to treat a fault.
fn every_step_both_ways(mut check: impl FnMut(u64, OnFault)) {
    for nth in 1..=STEPS {
        for on_fault in [OnFault::Hold, OnFault::Disable] {
            check(nth, on_fault);
        }
    }
}

#[test]
fn a_step_pin_that_does_not_rise_made_no_step() {
    every_step_both_ways(|nth, on_fault| {
        fails_and_stays(Failure { pin: Pin::Step, high: true, nth }, nth - 1, on_fault, false);
    });
}

#[test]
fn a_step_pin_that_does_not_fall_made_its_step() {
    every_step_both_ways(|nth, on_fault| {
        fails_and_stays(Failure { pin: Pin::Step, high: false, nth }, nth, on_fault, false);
    });
}

#[test]
fn an_index_pin_that_cannot_be_read_comes_after_its_step() {
    every_step_both_ways(|nth, on_fault| {
        fails_and_stays(Failure { pin: Pin::Index, high: true, nth }, nth, on_fault, true);
    });
}

#[test]
fn a_direction_pin_that_fails_at_the_start_or_the_turn_made_no_step() {
    for on_fault in [OnFault::Hold, OnFault::Disable] {
        fails_and_stays(Failure { pin: Pin::Direction, high: true, nth: 1 }, 0, on_fault, false);
        let at_turn = Failure { pin: Pin::Direction, high: false, nth: 1 };
        fails_and_stays(at_turn, AHEAD as u64, on_fault, false);
    }
}

#[test]
fn a_motor_that_cannot_be_enabled_does_not_start() {
    for pin in [Pin::Enable, Pin::Step] {
        let bench = Bench::default();
        let mut actuator = idle::<8>(&bench, Timing::default(), OnFault::Hold);
        bench.state().failures = vec![Failure { pin, high: false, nth: 1 }];
        let error = PinFault { pin, kind: ErrorKind::Other, made: false };
        assert_eq!(actuator.enable(), Err(Fault::Motor { error, position: 0 }));
        assert_eq!(start(&mut actuator, &bench, MOVE), Err(Fault::NotEnabled));
        assert_eq!(bench.steps_ns(), []);
    }
}

#[test]
fn the_first_error_is_told_when_letting_go_fails_too() {
    let bench = Bench::default();
    let mut actuator = on_pins::<8>(&bench, Timing::default(), OnFault::Disable);
    bench.state().failures = vec![
        Failure { pin: Pin::Step, high: true, nth: 5 },
        // The pin is active low, so a high level lets go.
        Failure { pin: Pin::Enable, high: true, nth: 1 },
        Failure { pin: Pin::Enable, high: true, nth: 1 },
    ];
    let due = start(&mut actuator, &bench, MOVE).unwrap();
    let told =
        |pin| Fault::Motor { error: PinFault { pin, kind: ErrorKind::Other, made: false }, position: 4 };
    assert_eq!(turn_on_time(&mut actuator, &bench, due), Err(told(Pin::Step)));
    assert_eq!(actuator.disable(), Err(told(Pin::Enable)));
    assert_eq!(actuator.start(0), Err(Fault::NotEnabled));
    assert_eq!(actuator.disable(), Ok(()));
}

/// A pin fails while the motor turns and no step is due.
#[test]
fn a_fault_between_two_steps_stops_the_motor_too() {
    for (pin, high) in [(Pin::Enable, false), (Pin::Index, true)] {
        let bench = Bench::default();
        let mut actuator = on_pins::<8>(&bench, Timing::default(), OnFault::Disable);
        let due = start(&mut actuator, &bench, MOVE).unwrap();
        bench.wait_until(due);
        let _ = actuator.on_timer(due).unwrap();
        bench.state().failures = vec![Failure { pin, high, nth: 1 }];
        let fault = if pin == Pin::Enable { actuator.enable() } else { actuator.watch_index() };
        let error = PinFault { pin, kind: ErrorKind::Other, made: false };
        assert_eq!(fault, Err(Fault::Motor { error, position: 1 }));
        assert_eq!(turn_on_time(&mut actuator, &bench, due + 500), Ok(()));
        assert_eq!((bench.state().rotor, actuator.stepper().position()), (1, 1));
    }
}

#[test]
fn a_step_pin_left_high_by_a_fault_is_low_long_enough_before_the_next_step() {
    let bench = Bench::default();
    let timing = Timing::new().with_enable_setup_ns(0);
    let mut actuator = on_pins::<8>(&bench, timing, OnFault::Hold);
    bench.state().failures = vec![Failure { pin: Pin::Step, high: false, nth: 3 }];
    let due = start(&mut actuator, &bench, MOVE).unwrap();
    assert!(turn_on_time(&mut actuator, &bench, due).is_err());
    actuator.enable().unwrap();
    let fell_ns = bench.state().log.iter().rfind(|event| event.pin == Pin::Step).unwrap().at_ns;
    assert!(actuator.stepper().clear());
    let due = start(&mut actuator, &bench, [Segment { interval: 1, ..even(1) }]).unwrap();
    turn_on_time(&mut actuator, &bench, due).unwrap();
    assert!(bench.steps_ns().last().unwrap() - fell_ns >= u64::from(timing.step_low_ns));
    assert_eq!((bench.state().rotor, actuator.stepper().position()), (4, 4));
}
