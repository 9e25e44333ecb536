//! Claims about the drivers, on pins, a delay and a clock that share one time line.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod blocking;
mod faults;
mod foreign;
mod index;
mod late;
mod pins;
mod wires;

use pump_ctl::drive::{Actuator, Fault, OnFault, StepDir, StepMotor, Timer, Timing};
use pump_ctl::plan::{Cruise, Doser, Limits, Motor, Phase, Plan, Request};
use pump_ctl::step::{Action, Feed, Segment, Stepper, TickRate};
use pump_model::Pump;
use wires::{Bench, Wire};

/// Rate of the timer in these tests. A tick is a microsecond.
const TICK_RATE: TickRate = TickRate::from_hz(1_000_000).unwrap();

const MOTOR: Motor = Motor::new(12_800.0, 17.8, 500.0);

type OnPins<const Q: usize> = Actuator<StepDir<Wire, Wire, Wire, Bench, Wire>, Q>;

/// Makes an enabled motor on pins.
fn on_pins<const Q: usize>(bench: &Bench, timing: Timing, on_fault: OnFault) -> OnPins<Q> {
    let mut actuator = idle(bench, timing, on_fault);
    actuator.enable().unwrap();
    actuator
}

/// Makes a motor on pins that is not enabled yet.
fn idle<const Q: usize>(bench: &Bench, timing: Timing, on_fault: OnFault) -> OnPins<Q> {
    let [step, direction, enable, index] = bench.wires();
    let driver = StepDir::new(step, direction, enable, bench.clone(), timing).with_index(index);
    Actuator::new(driver, Stepper::new(MOTOR.brake(TICK_RATE).unwrap()), on_fault)
}

fn dose(volume_ml: f64, flow_ml_s: f64) -> Plan {
    let request = Request::new(volume_ml, Cruise::Flow { ml_s: flow_ml_s });
    Doser::new(&Pump::three_roller(), Limits::new(MOTOR)).unwrap().plan(Phase::known(0.3), &request).unwrap()
}

/// Returns the ticks at which the steps of `segments` are due, for a start at tick `start`.
fn deadlines(segments: impl Iterator<Item = Segment>, start: u64) -> Vec<u64> {
    let mut stepper = Stepper::<256>::new(MOTOR.brake(TICK_RATE).unwrap());
    stepper.fill(&mut Feed::new(TICK_RATE, segments)).unwrap();
    let mut due = stepper.start(start).unwrap();
    let mut all = Vec::new();
    while let Action::Step { next, .. } = stepper.on_deadline(due) {
        all.push(due);
        due = next;
    }
    all
}

/// Makes the segments of a dose and of half of it back, in one move.
fn there_and_back(volume_ml: f64) -> impl Iterator<Item = Segment> {
    dose(volume_ml, 5.0).segments(TICK_RATE).chain(dose(-0.5 * volume_ml, 5.0).segments(TICK_RATE))
}

/// Queues all segments and starts at the bench's time.
fn start<M: StepMotor, const Q: usize>(
    actuator: &mut Actuator<M, Q>,
    bench: &Bench,
    segments: impl IntoIterator<Item = Segment>,
) -> Result<u64, Fault<M::Error>> {
    assert!(actuator.stepper().fill(&mut Feed::new(TICK_RATE, segments))?, "more segments than places");
    actuator.start(bench.tick())
}

/// Runs the timer's interrupt until the move is over, each call `late(n)` ticks late.
fn turn<M: StepMotor, const Q: usize>(
    actuator: &mut Actuator<M, Q>,
    bench: &Bench,
    mut due: u64,
    mut late: impl FnMut(u64) -> u64,
) -> Result<(), Fault<M::Error>> {
    for n in 1.. {
        bench.wait_until(due + late(n));
        match actuator.on_timer(bench.tick())? {
            Timer::At(next) => due = next,
            Timer::Done => break,
        }
    }
    Ok(())
}

/// Runs the timer's interrupt until the move is over, each call on time.
fn turn_on_time<M: StepMotor, const Q: usize>(
    actuator: &mut Actuator<M, Q>,
    bench: &Bench,
    due: u64,
) -> Result<(), Fault<M::Error>> {
    turn(actuator, bench, due, |_| 0)
}
