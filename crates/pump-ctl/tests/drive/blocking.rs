//! A whole move in one call.

use std::cell::Cell;

use pump_ctl::drive::{Clock, Fault, OnFault, Timing};
use pump_ctl::step::{Feed, PushError, Segment, StartError, TickRate};

use super::wires::Bench;
use super::{OnPins, TICK_RATE, deadlines, dose, idle, on_pins};

/// Places in the queue. They are few, so most of the plan is queued between steps.
const Q: usize = 4;

fn bench() -> Bench {
    let bench = Bench::default();
    bench.state().look_ns = [300, 1100];
    bench
}

fn actuator(bench: &Bench) -> OnPins<Q> {
    on_pins(bench, Timing::default(), OnFault::Hold)
}

#[test]
fn every_step_of_25_ml_comes_and_none_before_its_time() {
    let plan = dose(25.0, 5.0);
    let bench = bench();
    let mut actuator = actuator(&bench);
    // There is one look at the clock before the start.
    let start = bench.clone().now();
    bench.state().now_ns = 1000 * start;
    bench.state().look_ns = [0, 700];
    let mut segments = plan.segments(TICK_RATE).feed();
    assert_eq!(actuator.run(&mut bench.clone(), &mut segments, || false), Ok(()));
    assert_eq!(actuator.stepper().position(), plan.steps());
    assert_eq!(bench.state().rotor, plan.steps());
    let made = bench.steps_ns();
    let due = deadlines(plan.segments(TICK_RATE), start);
    assert_eq!(made.len(), due.len());
    for (made_ns, due) in made.iter().zip(due) {
        let late_ns = made_ns.checked_sub(1000 * due);
        // A step may wait for a look or two, and the first step for the direction pin.
        assert!(late_ns.is_some_and(|ns| ns <= 3000), "{late_ns:?} ns after {due} us");
    }
}

#[test]
fn the_stop_closure_decelerates() {
    let plan = dose(25.0, 5.0);
    let bench = bench();
    let mut actuator = actuator(&bench);
    let mut segments = plan.segments(TICK_RATE).feed();
    let asked = Cell::new(0);
    let stop = || {
        let stop = bench.state().rotor >= 5000;
        asked.set(asked.get() + u32::from(stop));
        stop
    };
    assert_eq!(actuator.run(&mut bench.clone(), &mut segments, stop), Ok(()));
    let position = bench.state().rotor;
    assert_eq!(actuator.stepper().position(), position);
    // 5 mL/s is 1.47 rad/s: 4.4 steps at the limit.
    assert!((5004..5010).contains(&position), "{position}");
    assert!(!actuator.stepper().is_moving());
    let gaps = bench.gaps_ns();
    assert!(gaps[5000..].windows(2).all(|pair| pair[1] + 2000 >= pair[0]), "{:?}", &gaps[5000..]);
    assert_eq!(asked.get(), 1, "once is enough");
}

#[test]
fn a_hiccup_decelerates_although_the_plan_is_not_queued_yet() {
    let bench = bench();
    let mut actuator = actuator(&bench);
    let mut segments = dose(25.0, 5.0).segments(TICK_RATE).feed();
    let hiccup = || {
        let mut state = bench.state();
        if state.rotor == 100 {
            state.now_ns += 20_000_000;
        }
        false
    };
    let end = actuator.run(&mut bench.clone(), &mut segments, hiccup);
    let position = bench.state().rotor;
    assert!(segments.peek().is_some() && position < 200, "{position}");
    assert!(matches!(end, Err(Fault::Late { position: at, .. }) if at == position), "{end:?}");
    assert!(!actuator.stepper().is_moving());
}

#[test]
fn a_segment_that_is_refused_on_the_way_decelerates_first() {
    let bench = bench();
    let mut actuator = actuator(&bench);
    let wrong = Segment::default();
    let good = dose(25.0, 5.0).segments(TICK_RATE).take(12);
    let fed: i64 = good.clone().map(|segment| i64::from(segment.count)).sum();
    let mut segments = Feed::new(TICK_RATE, good.chain([wrong]));
    let end = actuator.run(&mut bench.clone(), &mut segments, || false);
    assert_eq!(end, Err(Fault::Push(PushError::Segment(wrong))));
    assert!(!actuator.stepper().is_moving());
    let position = bench.state().rotor;
    let gaps = bench.gaps_ns();
    assert!(position > 10 && position <= fed && actuator.stepper().position() == position, "{position}");
    let (fastest, last) = (gaps.iter().min().unwrap(), gaps.last().unwrap());
    assert!(last > &(2 * fastest), "from {fastest} ns down to {last} ns");
}

#[test]
fn a_move_that_is_refused_leaves_nothing_queued() {
    let bench = bench();
    let mut actuator = idle::<Q>(&bench, Timing::default(), OnFault::Hold);
    let mut segments = dose(25.0, 5.0).segments(TICK_RATE).feed();
    let end = actuator.run(&mut bench.clone(), &mut segments, || false);
    assert_eq!(end, Err(Fault::NotEnabled));
    actuator.enable().unwrap();
    let wrong = [Segment { count: 5, interval: 500, add: 0, frac: 0 }, Segment::default()];
    let end = actuator.run(&mut bench.clone(), &mut Feed::new(TICK_RATE, wrong), || false);
    assert_eq!(end, Err(Fault::Push(PushError::Segment(wrong[1]))));
    let end = actuator.run(&mut bench.clone(), &mut Feed::new(TICK_RATE, []), || false);
    assert_eq!(end, Err(Fault::Start(StartError::Empty)));

    let kilohertz = TickRate::from_hz(1000).unwrap();
    let end = actuator.run(&mut bench.clone(), &mut dose(25.0, 5.0).segments(kilohertz).feed(), || false);
    let refused = PushError::TickRate { segments: kilohertz, brake: TICK_RATE };
    assert_eq!(end, Err(Fault::Push(refused)), "a brake of another timer is none");

    let back = dose(-0.2, 5.0);
    let mut segments = back.segments(TICK_RATE).feed();
    assert_eq!(actuator.run(&mut bench.clone(), &mut segments, || false), Ok(()));
    assert_eq!(bench.state().rotor, back.steps());
}
