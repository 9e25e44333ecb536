//! The end of a plan, which the executor never passes: stops, starvation and changes of plans that are longer than
//! the queue.

use pump_ctl::plan::{Cruise, Doser, Limits, Motor, Phase, Plan, Ramps, Request};
use pump_ctl::step::{Action, Brake, Feed, Segment, Stepper, TickRate};
use pump_model::Pump;

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
