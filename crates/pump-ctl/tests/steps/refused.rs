//! Segments and moves that the executor refuses.

use pump_ctl::plan::Motor;
use pump_ctl::step::{Action, Feed, PushError, Segment, StartError, Stepper};

use super::KILOHERTZ;

fn stepper() -> Stepper<3> {
    let motor = Motor::new(200.0, 6.0, 10.0);
    Stepper::new(motor.brake(KILOHERTZ).unwrap())
}

const EVEN: Segment = Segment { count: 5, interval: 10, add: 0, frac: 0 };

#[test]
fn impossible_segments_are_refused() {
    let refused = [
        Segment { count: 0, ..EVEN },
        Segment { interval: 0, frac: u32::MAX, ..EVEN },
        Segment { add: -(3 << 32), ..EVEN },
        Segment { interval: 1 << 49, ..EVEN },
        Segment { count: i32::MIN, ..EVEN },
        Segment { count: 1, add: i64::MIN, ..EVEN },
        Segment { count: i32::MAX, add: i64::MAX, ..EVEN },
    ];
    for segment in refused {
        assert_eq!(stepper().push(segment, KILOHERTZ), Err(PushError::Segment(segment)));
    }
    let message = stepper().push(refused[0], KILOHERTZ).unwrap_err().to_string();
    assert!(message.contains("count: 0") && message.contains("use a faster timer"), "{message}");
}

#[test]
fn a_full_queue_a_finished_move_and_a_stopped_motor_take_no_segment() {
    let mut stepper = stepper();
    for _ in 0..3 {
        stepper.push(EVEN, KILOHERTZ).unwrap();
    }
    assert_eq!(stepper.push(EVEN, KILOHERTZ), Err(PushError::Full));
    stepper.finish();
    assert_eq!(stepper.push(EVEN, KILOHERTZ), Err(PushError::Finished));
    let due = stepper.start(0).unwrap();
    assert_eq!(stepper.start(1), Err(StartError::Moving));
    assert!(!stepper.clear() && !stepper.set_position(0));
    assert_eq!(stepper.on_deadline(due - 1), Action::Wait);
    assert_eq!(stepper.position(), 0);
    stepper.halt(true);
    assert_eq!(stepper.on_deadline(due), Action::Done);
    assert_eq!(stepper.push(EVEN, KILOHERTZ), Err(PushError::Stopped));
    assert_eq!(stepper.start(1), Err(StartError::Stopped));
    assert!(stepper.clear());
    assert_eq!(stepper.start(1), Err(StartError::Empty));
    stepper.push(EVEN, KILOHERTZ).unwrap();
    stepper.start(1).unwrap();
}

#[test]
fn a_plan_is_queued_whole_or_refused_but_never_swallowed() {
    let plan = || Feed::new(KILOHERTZ, [EVEN, EVEN]);
    let mut stepper = stepper();
    stepper.finish();
    assert_eq!(stepper.fill(&mut plan()), Ok(true));
    assert_eq!(stepper.fill(&mut plan()), Err(PushError::Finished));
    assert_eq!(stepper.fill(&mut Feed::new(KILOHERTZ, [])), Ok(true));
    stepper.start(0).unwrap();
    assert_eq!(stepper.room(), 1);
}

#[test]
fn a_step_that_was_not_made_is_not_counted() {
    let mut stepper = stepper();
    stepper.push(EVEN, KILOHERTZ).unwrap();
    let mut due = stepper.start(0).unwrap();
    for _ in 0..2 {
        if let Action::Step { next, .. } = stepper.on_deadline(due) {
            due = next;
        }
    }
    stepper.halt(false);
    assert_eq!(stepper.position(), 1);
    assert!(!stepper.is_moving());
}
