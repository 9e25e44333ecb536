//! The end of a plan, which the executor never passes: stops, starvation and changes of plans that are longer than
//! the queue.

use pump_ctl::plan::{Cruise, Doser, Limits, Motor, Phase, Plan, Ramps, Request};
use pump_ctl::step::{Action, Brake, Feed, PushError, Segment, StartError, Stepper, StopPlan, TickRate};
use pump_model::Pump;

use super::interrupted::steepest;

const MEGAHERTZ: TickRate = TickRate::from_hz(1_000_000).unwrap();

/// A motor whose ramps are longer than a queue of 64 segments: 158 rad from full speed.
fn weak_motor() -> Motor {
    Motor::new(12_800.0, 17.8, 1.0)
}

/// A dose of 250 mL at 20 mL/s in some 500 segments, more than 200 of them for each ramp.
fn long_ramps() -> Plan {
    let request = Request::new(250.0, Cruise::Flow { ml_s: 20.0 }).with_ramps(Ramps::Fastest);
    Doser::new(&Pump::three_roller(), Limits::new(weak_motor()))
        .unwrap()
        .plan(Phase::known(0.3), &request)
        .unwrap()
}

fn brake() -> Brake {
    weak_motor().brake(MEGAHERTZ).unwrap()
}

/// Makes `steps` steps, and fills the queue after each.
fn refilled(stepper: &mut Stepper<64>, feed: &mut Feed<impl Iterator<Item = Segment>>, steps: i64) -> u64 {
    stepper.fill(feed).unwrap();
    let mut due = stepper.start(0).unwrap();
    for _ in 0..steps {
        let Action::Step { next, .. } = stepper.on_deadline(due) else { unreachable!() };
        due = next;
        stepper.fill(feed).unwrap();
    }
    due
}

/// Goes on without further segments until the motor stands.
fn to_rest(stepper: &mut Stepper<64>, due: u64) -> Action {
    let mut due = due;
    loop {
        match stepper.on_deadline(due) {
            Action::Step { next, .. } => due = next,
            ended => return ended,
        }
    }
}

#[test]
fn a_stop_of_a_plan_longer_than_the_queue_ends_within_the_plan() {
    let plan = long_ramps();
    for part in 0..50 {
        let mut stepper = Stepper::<64>::new(brake());
        let due = refilled(&mut stepper, &mut plan.segments(MEGAHERTZ).feed(), part * plan.steps() / 50);
        let promise = stepper.stop(due - 1);
        assert!(
            promise.final_count <= plan.steps(),
            "{part}: {} steps beyond",
            promise.final_count - plan.steps()
        );
        assert_eq!(to_rest(&mut stepper, due), Action::Done);
        assert_eq!(stepper.position(), promise.final_count);
    }
}

#[test]
fn a_queue_that_runs_dry_on_the_last_ramp_ends_within_the_plan() {
    let plan = long_ramps();
    for part in 0..50 {
        let mut stepper = Stepper::<64>::new(brake());
        let due = refilled(&mut stepper, &mut plan.segments(MEGAHERTZ).feed(), part * plan.steps() / 50);
        assert!([Action::Starved, Action::Done].contains(&to_rest(&mut stepper, due)));
        assert!(
            stepper.position() <= plan.steps(),
            "{part}: {} steps beyond",
            stepper.position() - plan.steps()
        );
    }
}

#[test]
fn a_finish_after_a_stop_changes_no_answer() {
    let plan = long_ramps();
    for part in 0..50 {
        let mut stepper = Stepper::<64>::new(brake());
        let due = refilled(&mut stepper, &mut plan.segments(MEGAHERTZ).feed(), part * plan.steps() / 50);
        let promise = stepper.stop(due - 1);
        stepper.finish();
        assert_eq!(stepper.stop(due - 1), promise, "{part}");
        assert_eq!(to_rest(&mut stepper, due), Action::Done);
        assert_eq!(stepper.position(), promise.final_count);
    }
}

/// Starts the plan, goes to step `made`, and lets the queue run dry there. Returns when steps were made.
fn starved_at(plan: &Plan, made: i64) -> (Stepper<64>, Vec<u64>) {
    let mut stepper = Stepper::<64>::new(brake());
    let mut due = refilled(&mut stepper, &mut plan.segments(MEGAHERTZ).feed(), made);
    let mut ticks = Vec::new();
    while let Action::Step { next, .. } = stepper.on_deadline(due) {
        ticks.push(due);
        due = next;
    }
    (stepper, ticks)
}

#[test]
fn the_way_to_the_end_is_as_steep_as_the_plan_and_no_steeper() {
    let plan = long_ramps();
    let limit = plan.profile().acceleration_rad_s2();
    for part in 70..100 {
        let (stepper, ticks) = starved_at(&plan, part * plan.steps() / 100);
        let found = steepest(&ticks, MEGAHERTZ.hz()) * plan.step_rad();
        assert!(found <= 1.02 * limit, "{part}: {found} rad/s^2");
        assert!(stepper.position() <= plan.steps());
    }
    // On the last ramp the motor stands where the plan ends, and in the plan's time to a thousandth.
    let made = 9 * plan.steps() / 10;
    let (stepper, ticks) = starved_at(&plan, made);
    assert_eq!(stepper.position(), plan.steps());
    let planned = plan.profile().duration_s() * f64::from(MEGAHERTZ.hz());
    let last = *ticks.last().unwrap() as f64;
    assert!((last / planned - 1.0).abs() < 1e-3, "{last} {planned}");
}

#[test]
fn a_segment_that_leads_beyond_the_end_or_away_from_it_is_refused() {
    let mut stepper = Stepper::<4>::new(brake());
    let ten = Segment { count: 10, interval: 5000, add: 0, frac: 0 };
    assert!(stepper.set_position(100));
    stepper.set_end(115).unwrap();
    stepper.push(ten, MEGAHERTZ).unwrap();
    assert_eq!(stepper.push(ten, MEGAHERTZ), Err(PushError::Beyond { end: 115, reaches: 120 }));
    let back = Segment { count: -1, ..ten };
    assert_eq!(stepper.push(back, MEGAHERTZ), Err(PushError::Beyond { end: 115, reaches: 109 }));
    stepper.push(Segment { count: 5, ..ten }, MEGAHERTZ).unwrap();
    assert_eq!(stepper.end(), Some(115));
    // A new end opens the way back.
    stepper.set_end(114).unwrap();
    stepper.push(back, MEGAHERTZ).unwrap();
    let mut due = stepper.start(0).unwrap();
    while let Action::Step { next, .. } = stepper.on_deadline(due) {
        due = next;
    }
    // The move is complete at its end, without finish().
    assert_eq!((stepper.position(), stepper.on_deadline(due), stepper.end()), (114, Action::Done, None));
    assert_eq!(stepper.start(due), Err(StartError::Empty));
    stepper.push(back, MEGAHERTZ).unwrap();
    stepper.finish();
    assert_eq!(stepper.set_end(0), Err(PushError::Finished));
    stepper.stop(0);
    assert_eq!(stepper.set_end(0), Err(PushError::Stopped));
}

#[test]
fn a_new_plan_leads_beyond_the_old_end_only_when_its_own_is_told() {
    let even = Segment { count: 50, interval: 2000, add: 0, frac: 0 };
    for told in [false, true] {
        let mut stepper = Stepper::<8>::new(brake());
        stepper.fill(&mut Feed::new(MEGAHERTZ, [even]).with_steps(50)).unwrap();
        let due = stepper.start(0).unwrap();
        let junction = stepper.retarget(20_000).unwrap();
        assert_eq!((junction.position, stepper.end()), (10, Some(50)));
        if told {
            stepper.set_end(60).unwrap();
            stepper.push(even, MEGAHERTZ).unwrap();
        } else {
            assert_eq!(stepper.push(even, MEGAHERTZ), Err(PushError::Beyond { end: 50, reaches: 60 }));
        }
        let (_, ended) = drain(&mut stepper, due);
        assert_eq!(ended, if told { Action::Done } else { Action::Starved });
        assert!(stepper.position() <= if told { 60 } else { 50 });
    }
}

fn drain(stepper: &mut Stepper<8>, due: u64) -> (u64, Action) {
    let mut due = due;
    loop {
        match stepper.on_deadline(due) {
            Action::Step { next, .. } => due = next,
            ended => return (due, ended),
        }
    }
}

#[test]
fn a_plan_without_an_end_is_stopped_by_the_brake_alone() {
    // Continuous running: the brake may lead beyond what is queued.
    let even = Segment { count: 1000, interval: 50, add: 0, frac: 0 };
    let mut stepper = Stepper::<8>::new(brake());
    stepper.push(even, MEGAHERTZ).unwrap();
    let due = stepper.start(0).unwrap();
    let Action::Step { next, .. } = stepper.on_deadline(due) else { unreachable!() };
    let StopPlan { last_step_at, final_count } = stepper.stop(due);
    assert!(final_count > 1000);
    assert_eq!(drain(&mut stepper, next), (last_step_at, Action::Done));
    assert_eq!(stepper.position(), final_count);
}
