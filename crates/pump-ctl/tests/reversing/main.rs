//! Claims about doses with heads whose flow reverses.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod heads;
mod known;
mod low_flow;
mod moves;
mod reference;
mod smooth;
mod unknown;

use pump_ctl::plan::{Cruise, Doser, Limits, Motor, Phase, Plan, PlanError, Ramps, Request};
use pump_model::Pump;

/// Makes the limits of a motor with a number of steps.
fn limits(steps_per_rev: f64) -> Limits {
    Limits::new(Motor::new(steps_per_rev, 17.8, 500.0))
}

/// Makes a request for a dose at 1 rad/s in plain ramps, which take least time to plan.
fn request(volume_ml: f64) -> Request {
    Request::new(volume_ml, Cruise::Speed { rad_s: 1.0 }).with_ramps(Ramps::Fastest)
}

fn planned(pump: &Pump, start: Phase, request: &Request, steps_per_rev: f64) -> Result<Plan, PlanError> {
    Doser::new(pump, limits(steps_per_rev))?.plan(start, request)
}

/// Numbers between 0 and 1, the same in every run.
struct Dice(u64);

impl Dice {
    /// Multiplier and increment of Knuth's MMIX (The Art of Computer Programming 2, 3.3.4).
    fn roll(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}
