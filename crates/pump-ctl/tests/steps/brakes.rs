//! Brakes: a motor that turns can always be stopped.

use proptest::prelude::*;
use pump_ctl::plan::Motor;
use pump_ctl::step::{Action, Brake, BrakeError, PushError, Segment, Stepper, TickRate, Ticks};

use super::{KILOHERTZ, any_case, run};

const MOTOR: Motor = Motor::new(12_800.0, 17.8, 500.0);

const MEGAHERTZ: TickRate = TickRate::from_hz(1_000_000).unwrap();

const EVEN: Segment = Segment { count: 5, interval: 10, add: 0, frac: 0 };

#[test]
fn a_motor_that_could_not_be_stopped_has_no_brake() {
    for value in [0.0, -500.0, f64::NAN, f64::INFINITY] {
        for motor in [
            MOTOR.with_max_acceleration_rad_s2(value),
            MOTOR.with_max_speed_rad_s(value),
            MOTOR.with_steps_per_rev(value),
        ] {
            let refused = motor.brake(MEGAHERTZ);
            assert!(matches!(refused, Err(BrakeError::OutOfRange { .. })), "{motor:?}: {refused:?}");
        }
    }
    let message = MOTOR.with_max_acceleration_rad_s2(0.0).brake(MEGAHERTZ).unwrap_err().to_string();
    assert!(message.starts_with("largest acceleration in rad/s2 is 0; allowed: "), "{message}");
    // The first step from rest takes 1.4 ms.
    let tick_rate = TickRate::from_hz(100).unwrap();
    assert_eq!(MOTOR.brake(tick_rate), Err(BrakeError::SlowTimer { tick_rate }));
    assert_eq!(TickRate::from_hz(0), None);
}

#[test]
fn a_brake_must_speed_up_from_rest() {
    let slow = Segment { count: 2, interval: 20, add: -(1 << 32), frac: 0 };
    assert!(Brake::from_climb(KILOHERTZ, [slow, EVEN]).is_ok());
    let refused = |number, segment| Err(BrakeError::Segment { number, segment });
    assert_eq!(Brake::from_climb(KILOHERTZ, [EVEN, slow]), refused(2, slow));
    let back = Segment { count: -2, ..slow };
    assert_eq!(Brake::from_climb(KILOHERTZ, [back]), refused(1, back));
    assert_eq!(Brake::from_climb(KILOHERTZ, [EVEN; 33]), Err(BrakeError::TooMany));
    assert_eq!(Brake::from_climb(KILOHERTZ, []), Err(BrakeError::Empty));
    assert_eq!(Brake::from_climb(KILOHERTZ, [Segment::default(); 32]), refused(1, Segment::default()));
}

#[test]
fn segments_for_another_timer_than_the_brakes_are_refused() {
    let mut stepper = Stepper::<2>::new(MOTOR.brake(MEGAHERTZ).unwrap());
    let refused = PushError::TickRate { segments: KILOHERTZ, brake: MEGAHERTZ };
    assert_eq!(stepper.push(EVEN, KILOHERTZ), Err(refused));
    assert_eq!(stepper.room(), 2);
    assert_eq!(
        refused.to_string(),
        "the segment is made for 1000 ticks a second, and the brake for 1000000 ticks a second; make both for \
         the timer that fires"
    );
    stepper.push(EVEN, stepper.tick_rate()).unwrap();
}

proptest! {
    #[test]
    fn the_descent_is_the_way_down_that_the_executor_takes(case in any_case(), part in 0.0..1.0_f64) {
        let brake = case.motor.brake(case.tick_rate).unwrap();
        // A long run at an interval of the way down, which a stop then ends.
        let span = brake.climb().map(|segment| segment.interval).max().unwrap_or(1);
        let interval = Ticks { whole: 1 + (part * span as f64) as u64, frac: 0 };
        let even = Segment {
            count: 1_000_000 * i32::from(case.plan.direction().sign()),
            interval: interval.whole,
            add: 0,
            frac: 0,
        };
        let mut stepper = super::Executor::new(brake);
        stepper.push(even, case.tick_rate).unwrap();
        let first = stepper.start(0).unwrap();
        let Action::Step { next, .. } = stepper.on_deadline(first) else { unreachable!() };
        let promise = stepper.stop(next - 1);
        let way: Vec<_> = brake.descent(interval, case.plan.direction()).collect();
        let steps: i64 = way.iter().map(|segment| i64::from(segment.count)).sum();
        // A motor slow enough stands at once. Any other makes the step that is due first.
        let due = if way.is_empty() { 0 } else { i64::from(case.plan.direction().sign()) };
        let start = i64::from(case.plan.direction().sign());
        prop_assert_eq!(promise.final_count, start + due + steps);
        let (made, _) = run(&mut stepper, next);
        let mut carry = Segment::CARRY;
        let mut at = first;
        let evens = [Segment { count: due as i32, ..even }];
        let expected: Vec<u64> = evens
            .iter()
            .filter(|segment| segment.count != 0)
            .chain(&way)
            .flat_map(|segment| segment.intervals(&mut carry).collect::<Vec<_>>())
            .map(|ticks| { at += ticks; at })
            .collect();
        prop_assert_eq!(made, expected);
    }

    #[test]
    fn the_sums_of_the_intervals_are_the_executors_deadlines(case in any_case(), start in 0..1_u64 << 50) {
        let mut stepper = case.queued();
        let due = stepper.start(start).unwrap();
        let (made, _) = run(&mut stepper, due);
        let (mut at, mut carry, mut ends) = (start, Segment::CARRY, (0_u128, 0_u128));
        let mut expected = Vec::new();
        for segment in case.plan.segments(case.tick_rate) {
            for ticks in segment.intervals(&mut carry) {
                at += ticks;
                expected.push(at);
            }
            let Ticks { whole, frac } = segment.duration();
            ends = (ends.0 + u128::from(whole), ends.1 + u128::from(frac));
        }
        prop_assert_eq!(made.last(), expected.last());
        prop_assert_eq!(made, expected);
        let rounded = ends.0 + ((ends.1 + (1 << 31)) >> 32);
        prop_assert_eq!(u128::from(at - start), rounded);
    }
}
