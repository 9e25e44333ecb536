//! Positions of the motor in the past, and moves after moves.

use proptest::prelude::*;
use pump_ctl::plan::Motor;
use pump_ctl::step::{Action, Feed, Segment, Stepper};

use super::{KILOHERTZ, any_case, run};

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, ..ProptestConfig::default() })]

    #[test]
    fn the_position_at_any_past_time_is_known(
        case in any_case(),
        part in 0.1..1.5_f64,
        asked in prop::collection::vec(0.0..1.1_f64, 50),
    ) {
        let mut stepper = case.queued();
        let mut due = stepper.start(1000).unwrap();
        let mut made = Vec::new();
        let count = (part * case.plan.steps().unsigned_abs() as f64) as usize;
        while made.len() < count && let Action::Step { next, .. } = stepper.on_deadline(due) {
            made.push(due);
            due = next;
        }
        if part > 0.5 {
            stepper.stop(due);
            made.extend(run(&mut stepper, due).0);
        }
        let last = made.last().copied().unwrap_or(1000);
        for part in asked {
            let t = 1000 + (part * (last - 1000) as f64) as u64;
            let expected = made.iter().filter(|at| **at <= t).count() as i64;
            prop_assert_eq!(stepper.position_at(t), Some(case.direction() * expected));
            if part <= 0.5 {
                let planned = case.plan.segments(case.tick_rate).steps_by(t - 1000);
                prop_assert!(t > last || planned as i64 == expected);
            }
        }
        prop_assert_eq!(stepper.position_at(999), None);
    }
}

#[test]
fn a_move_may_turn_round_and_moves_may_follow_each_other() {
    let motor = Motor::new(200.0, 1.0, 10.0);
    let mut stepper = Stepper::<2>::new(motor.brake(KILOHERTZ).unwrap());
    let ahead = Segment { count: 3, interval: 10, add: 0, frac: 1 << 31 };
    let back = Segment { count: -2, interval: 100, add: -(10 << 32), frac: 0 };
    for start in [0, 5000] {
        assert!(stepper.fill(&mut Feed::new(KILOHERTZ, [ahead, back])).unwrap());
        let mut due = stepper.start(start).unwrap();
        let mut made = Vec::new();
        while let Action::Step { direction, next } = stepper.on_deadline(due) {
            made.push((due - start, direction.sign()));
            due = next;
        }
        // The steps are due at 10.5, 21, 31.5, 131.5 and 221.5, rounded half up.
        assert_eq!(made, [(11, 1), (21, 1), (32, 1), (132, -1), (222, -1)]);
    }
    assert_eq!(stepper.position(), 2);
    assert_eq!(stepper.position_at(5031), Some(3));
    assert_eq!(stepper.position_at(5032), Some(4));
    // The segments of the first move have given way.
    assert_eq!(stepper.position_at(20), None);
}
