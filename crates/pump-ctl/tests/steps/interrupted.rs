//! Stops, changes of plan, and queues that run dry.

use proptest::prelude::*;
use pump_ctl::step::{Action, Feed, PushError, StopPlan};

use super::{Case, Executor, any_case, run};

/// Returns the largest deceleration, steps/s², of steps made at `ticks`, by the mean speeds of neighbouring
/// intervals.
pub(crate) fn steepest(ticks: &[u64], tick_hz: u32) -> f64 {
    let hz = f64::from(tick_hz);
    ticks
        .windows(3)
        .map(|t| {
            // Rounding moves a step by half a tick at most. Its time is a quarter of a tick from the plan's.
            let (before, after) = ((t[1] - t[0]) as f64 + 1.5, (t[2] - t[1]) as f64 - 1.5);
            2.0 * (hz / before - hz / after) / ((before + after) / hz)
        })
        .fold(f64::NEG_INFINITY, f64::max)
}

/// Runs until `part` of the steps are made. Returns their times and the next deadline.
fn run_to(stepper: &mut Executor, case: &Case, part: f64) -> (Vec<u64>, u64) {
    let mut due = stepper.start(1000).unwrap();
    let mut made = Vec::new();
    for _ in 0..(part * case.plan.steps().unsigned_abs() as f64) as u64 {
        let Action::Step { next, .. } = stepper.on_deadline(due) else { unreachable!() };
        made.push(due);
        due = next;
    }
    (made, due)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 3000, ..ProptestConfig::default() })]

    #[test]
    fn a_stop_ends_where_and_when_it_said_within_the_deceleration(case in any_case(), part in 0.0..1.0_f64) {
        let mut stepper = case.queued();
        let (mut made, due) = run_to(&mut stepper, &case, part);
        let before = stepper.position();
        let last_interval = made.last().map_or(u64::MAX, |last| due - last);
        let promise = stepper.stop(due - 1);
        prop_assert_eq!(stepper.stop(due - 1), promise);
        let stopped_from = made.len();
        let (rest, end) = run(&mut stepper, due);
        made.extend(rest);
        prop_assert_eq!(end, Action::Done);
        let last = made.last().copied().unwrap_or(1000);
        prop_assert_eq!(promise, StopPlan { last_step_at: last, final_count: stepper.position() });
        // The motor never makes more steps than planned, and never turns back.
        let along = case.direction() * stepper.position();
        prop_assert!(along <= case.plan.steps().abs() && along >= case.direction() * before);
        // The motor stops as soon as the limit allows, within twice the angle.
        let speed = f64::from(case.tick_rate.hz()) / last_interval as f64 * case.plan.step_rad();
        let limit = case.motor.max_acceleration_rad_s2;
        let shortest = speed * speed / (2.0 * limit) / case.plan.step_rad();
        prop_assert!((made.len() - stopped_from) as f64 <= 2.0 * shortest + 3.0);
        let from = stopped_from.saturating_sub(1);
        prop_assert!(steepest(&made[from..], case.tick_rate.hz()) * case.plan.step_rad() <= 1.02 * limit);
        let segment = case.plan.segments(case.tick_rate).next().unwrap();
        prop_assert_eq!(stepper.push(segment, case.tick_rate), Err(PushError::Stopped));
    }

    #[test]
    fn an_overdue_step_is_not_made_up_for_by_a_stop(
        case in any_case(),
        part in 0.0..1.0_f64,
        late in 1..100_000_u64,
    ) {
        let mut stepper = case.queued();
        let (_, due) = run_to(&mut stepper, &case, part);
        let interval = stepper.next_deadline();
        let now = due + late;
        let promise = stepper.stop(now);
        let next = stepper.next_deadline();
        // Either the plan is at its end, or the next step is still to come.
        let at_its_end = Some(due) == interval && promise.final_count == case.plan.steps();
        prop_assert!(next.is_none_or(|next| next > now) || at_its_end);
        let (made, _) = run(&mut stepper, next.unwrap_or(now));
        prop_assert_eq!(stepper.position(), promise.final_count);
        if let Some(last) = made.last() {
            prop_assert_eq!(*last, promise.last_step_at);
        }
    }

    #[test]
    fn a_queue_that_runs_dry_decelerates_the_motor(case in any_case(), keep in 1_usize..60) {
        let segments: Vec<_> = case.plan.segments(case.tick_rate).collect();
        let keep = keep.min(segments.len());
        let mut stepper = Executor::new(case.motor.brake(case.tick_rate).unwrap());
        for segment in &segments[..keep] {
            stepper.push(*segment, case.tick_rate).unwrap();
        }
        let due = stepper.start(0).unwrap();
        let (made, end) = run(&mut stepper, due);
        prop_assert_eq!(end, Action::Starved);
        let fed: u32 = segments[..keep].iter().map(|segment| segment.steps()).sum();
        let from = (fed as usize).saturating_sub(2);
        let steepest_rad_s2 = steepest(&made[from..], case.tick_rate.hz()) * case.plan.step_rad();
        prop_assert!(steepest_rad_s2 <= 1.02 * case.motor.max_acceleration_rad_s2);
        prop_assert_eq!(made.len() as i64, case.direction() * stepper.position());
    }

    #[test]
    fn a_plan_can_be_replaced_after_any_step_to_come(
        case in any_case(),
        part in 0.0..0.9_f64,
        lead_s in 0.0..0.01_f64,
    ) {
        let mut punctual = case.queued();
        let first = punctual.start(1000).unwrap();
        let (expected, _) = run(&mut punctual, first);
        let mut stepper = case.queued();
        let (mut made, due) = run_to(&mut stepper, &case, part);
        let not_before = due + (lead_s * f64::from(case.tick_rate.hz())) as u64;
        let promised = stepper.junction(not_before);
        prop_assert_eq!(stepper.junction(not_before), promised);
        let junction = stepper.retarget(not_before);
        prop_assert_eq!(junction, promised);
        let Some(at) = expected.iter().skip(made.len()).position(|t| *t >= not_before) else {
            prop_assert!(junction.is_none());
            return Ok(());
        };
        let kept = made.len() + at + 1;
        if kept == expected.len() {
            prop_assert!(junction.is_none());
            return Ok(());
        }
        let junction = junction.unwrap();
        prop_assert_eq!(junction.at, expected[kept - 1]);
        prop_assert_eq!(junction.position, case.direction() * kept as i64);
        // The new plan goes on evenly for ten steps.
        let segment = pump_ctl::step::Segment {
            count: 10 * i32::from(case.plan.direction().sign()),
            interval: junction.interval.max(1),
            add: 0,
            frac: 0,
        };
        stepper.set_end(junction.position + i64::from(segment.count)).unwrap();
        stepper.push(segment, case.tick_rate).unwrap();
        stepper.finish();
        let (rest, end) = run(&mut stepper, due);
        made.extend(rest);
        prop_assert_eq!(end, Action::Done);
        prop_assert_eq!(made.len(), kept + 10);
        prop_assert_eq!(&made[..kept], &expected[..kept]);
        prop_assert!(made[kept].abs_diff(junction.at + segment.interval) <= 1);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, ..ProptestConfig::default() })]

    #[test]
    fn a_stop_adds_one_step_at_most_to_a_plan_that_is_not_marked_as_complete(
        case in any_case(),
        part in 0.0..1.0_f64,
    ) {
        let mut stepper = Executor::new(case.motor.brake(case.tick_rate).unwrap());
        for segment in case.plan.segments(case.tick_rate) {
            stepper.push(segment, case.tick_rate).unwrap();
        }
        let (mut made, due) = run_to(&mut stepper, &case, part);
        let promise = stepper.stop(due - 1);
        prop_assert!(case.direction() * promise.final_count <= case.plan.steps().abs() + 1);
        prop_assert_eq!(stepper.stop(due - 1), promise);
        let (rest, end) = run(&mut stepper, due);
        made.extend(rest);
        prop_assert_eq!(end, Action::Done);
        prop_assert_eq!(stepper.position(), promise.final_count);
        if let Some(last) = made.last() {
            prop_assert_eq!(*last, promise.last_step_at);
        }
    }
}

#[test]
fn a_motor_that_stands_makes_no_step_when_it_is_stopped() {
    let motor = pump_ctl::plan::Motor::new(12_800.0, 17.8, 500.0);
    let case = Case::new(motor, 1_000_000, 2.0, 0.0, 7.0);
    let back = Case::new(motor, 1_000_000, -1.0, 0.0, 7.0);
    for late in [0, 10_000] {
        // The motor stops before its first step.
        let mut stepper = case.queued();
        stepper.start(0).unwrap();
        assert_eq!(stepper.stop(late), StopPlan { last_step_at: 0, final_count: 0 });
        assert_eq!(stepper.on_deadline(1_000_000), Action::Done);
        // The motor stops where it turns round.
        let mut stepper = Executor::new(motor.brake(case.tick_rate).unwrap());
        let both = case.plan.segments(case.tick_rate).chain(back.plan.segments(case.tick_rate));
        stepper.fill(&mut Feed::new(case.tick_rate, both)).unwrap();
        let mut due = stepper.start(0).unwrap();
        let mut last = 0;
        while stepper.position() < case.plan.steps() {
            let Action::Step { next, .. } = stepper.on_deadline(due) else { unreachable!() };
            (last, due) = (due, next);
        }
        let promise = StopPlan { last_step_at: last, final_count: case.plan.steps() };
        assert_eq!(stepper.stop(last + late), promise);
    }
}

#[test]
fn a_slow_motor_stands_at_once() {
    let motor = pump_ctl::plan::Motor::new(400.0, 1.0, 500.0);
    let case = Case::new(motor, 1_000_000, 2.0, 0.0, 1e-4);
    let mut stepper = case.queued();
    let (made, due) = run_to(&mut stepper, &case, 0.5);
    let promise = stepper.stop(due - 1_000_000);
    assert_eq!(promise, StopPlan { last_step_at: *made.last().unwrap(), final_count: made.len() as i64 });
    assert_eq!(stepper.on_deadline(due), Action::Done);
}
