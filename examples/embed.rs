//! The planner inside another actuator stack: your own motor object gets absolute step times from `pump-ctl`.
//!
//! `cargo run --example embed`

use pump_ctl::plan::{Cruise, Limits, Motor, Phase, PlanError, Request, plan};
use pump_model::Pump;

/// What your stack has: something that makes a step at a time.
trait Axis {
    fn step_at(&mut self, time_us: u64, forward: bool);
}

/// Stands in for your hardware: counts.
#[derive(Default)]
struct Counter {
    position: i64,
    last_us: u64,
}

impl Axis for Counter {
    fn step_at(&mut self, time_us: u64, forward: bool) {
        self.position += if forward { 1 } else { -1 };
        self.last_us = time_us;
    }
}

/// Doses `volume_ml` and returns what the next dose owes, mL.
fn dose(
    axis: &mut impl Axis,
    pump: &Pump,
    limits: &Limits,
    angle_rad: f64,
    volume_ml: f64,
) -> Result<f64, PlanError> {
    let request = Request::new(volume_ml, Cruise::Flow { ml_s: 5.0 });
    let plan = plan(pump, Phase::known(angle_rad), &request, limits)?;
    for step in plan.steps() {
        axis.step_at((1e6 * step.time_s).round() as u64, step.direction > 0);
    }
    Ok(plan.carry_ml)
}

fn main() -> Result<(), PlanError> {
    let motor = Motor { steps_per_rev: 12_800.0, max_speed_rad_s: 17.8, max_acceleration_rad_s2: 500.0 };
    let mut limits = Limits::of_motor(motor);
    limits.max_outlet_kpa = Some(120.0);
    let mut axis = Counter::default();
    let carry_ml = dose(&mut axis, &Pump::three_roller(), &limits, 0.3, 25.0)?;
    #[allow(clippy::print_stdout, reason = "an example shows its result")]
    {
        println!("{} steps in {} us, {:.2} uL owed", axis.position, axis.last_us, 1e3 * carry_ml);
    }
    Ok(())
}
