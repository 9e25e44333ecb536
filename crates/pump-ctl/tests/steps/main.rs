//! Claims about the step executor, over random motors, doses, timers and interruptions.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod brakes;
mod ends;
mod executed;
mod interrupted;
mod refused;
mod sequences;
mod times;

use proptest::prelude::*;
use pump_ctl::plan::{Cruise, Doser, Limits, Motor, Phase, Plan, Request};
use pump_ctl::step::{Stepper, TickRate};
use pump_model::Pump;

/// Places in the queue, enough for whole moves in these tests.
type Executor = Stepper<4096>;

/// Timer of hand-made segments.
const KILOHERTZ: TickRate = TickRate::from_hz(1000).unwrap();

const TURN_RAD: f64 = core::f64::consts::TAU;

/// A dose of the three-roller pump and the timer that makes its steps.
#[derive(Debug, Clone)]
struct Case {
    motor: Motor,
    plan: Plan,
    tick_rate: TickRate,
}

impl Case {
    fn new(motor: Motor, tick_hz: u32, volume_ml: f64, start_rad: f64, speed_rad_s: f64) -> Self {
        let request = Request::new(volume_ml, Cruise::Speed { rad_s: speed_rad_s });
        let plan = Doser::new(&Pump::three_roller(), Limits::new(motor))
            .unwrap()
            .plan(Phase::known(start_rad), &request)
            .unwrap();
        Self { motor, plan, tick_rate: TickRate::from_hz(tick_hz).unwrap() }
    }

    /// Makes the executor with the whole plan queued.
    fn queued(&self) -> Executor {
        let mut stepper = Executor::new(self.motor.brake(self.tick_rate).unwrap());
        assert!(
            stepper.fill(&mut self.plan.segments(self.tick_rate).feed()).unwrap(),
            "more than 4096 segments"
        );
        stepper
    }

    /// Returns the times at which the plan makes its steps, ticks since the start.
    fn planned_ticks(&self) -> Vec<f64> {
        self.plan.each_step().map(|step| step.time_s * f64::from(self.tick_rate.hz())).collect()
    }

    fn direction(&self) -> i64 {
        i64::from(self.plan.direction().sign())
    }
}

/// Draws doses of up to some 20,000 steps, with motors and timers of all kinds.
fn any_case() -> impl Strategy<Value = Case> {
    let motor = (200.0..20_000.0_f64, 1.0..20.0_f64, 1.0..2000.0_f64)
        .prop_map(|(steps, speed, acceleration)| Motor::new(steps.round(), speed, acceleration));
    let tick_hz = prop_oneof![Just(1_000_000), Just(168_000_000), 500_000..20_000_000_u32];
    (motor, tick_hz, 0.5..30.0_f64, any::<bool>(), 0.0..TURN_RAD, 0.01..1.0_f64).prop_map(
        |(motor, tick_hz, volume, reverse, start, speed)| {
            let volume = if reverse { -volume } else { volume };
            Case::new(motor, tick_hz, volume, start, speed * motor.max_speed_rad_s)
        },
    )
}

/// Calls the executor at each of its deadlines from `due` on until it stands. Returns when steps were made.
fn run(stepper: &mut Executor, due: u64) -> (Vec<u64>, pump_ctl::step::Action) {
    use pump_ctl::step::Action;
    let mut made = Vec::new();
    let mut now = due;
    loop {
        match stepper.on_deadline(now) {
            Action::Step { next, .. } => {
                made.push(now);
                now = next;
            }
            other => return (made, other),
        }
    }
}
