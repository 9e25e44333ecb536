//! Doses inside a control loop that has a clock and a motor of its own. Every millisecond a servo axis is
//! told where the plan's rotor is now. Someone stops the dose midway, and the angle that the axis has
//! really turned gives the delivered volume.
//!
//! `cargo run --example foreign_loop`

use pump_ctl::plan::{Cruise, Doser, Limits, Motor, Phase, Plan, PlanError, Request};
use pump_model::{Leg, Pump};

/// Period of the loop, s.
const PERIOD_S: f64 = 1e-3;

/// Servo axis in the place of your motor: it follows a position set-point, some milliseconds behind.
struct Servo {
    angle_rad: f64,
}

impl Servo {
    fn command(&mut self, set_point_rad: f64) {
        self.angle_rad += 0.2 * (set_point_rad - self.angle_rad);
    }
}

/// Follows the plan until it ends, or until the time `stop_asked`, s. Returns the time at which the axis
/// stands, s.
fn follow(servo: &mut Servo, plan: &Plan, stop_asked: impl Fn(f64) -> bool) -> f64 {
    let mut stopping: Option<Leg> = None;
    let mut t_s = 0.0;
    loop {
        if stopping.is_none() && stop_asked(t_s) {
            stopping = Some(plan.stop_at(t_s));
        }
        let (set_point_rad, ends_s) = match stopping {
            Some(leg) => (leg.angle_at(t_s.min(leg.end_s())), leg.end_s()),
            None => (plan.angle_at(t_s), plan.profile().duration_s()),
        };
        servo.command(set_point_rad);
        if t_s >= ends_s && (set_point_rad - servo.angle_rad).abs() < 0.5 * plan.step_rad() {
            return t_s;
        }
        t_s += PERIOD_S;
    }
}

/// Makes a dose of 25 mL that is stopped after 2.5 s, and then the rest of it.
fn report() -> Result<String, PlanError> {
    let pump = Pump::three_roller();
    // For a servo a step is an increment of its encoder.
    let motor = Motor::new(65_536.0, 17.8, 50.0);
    let limits = Limits::new(motor);
    let cruise = Cruise::Flow { ml_s: 5.0 };
    let start_rad = 0.3;
    let mut servo = Servo { angle_rad: start_rad };
    let delivered_ml = |servo: &Servo| {
        pump.outlet_curve().volume_ml(servo.angle_rad) - pump.outlet_curve().volume_ml(start_rad)
    };

    let doser = Doser::new(&pump, limits)?;
    let dose = doser.plan(Phase::known(start_rad), &Request::new(25.0, cruise))?;
    let stood_s = follow(&mut servo, &dose, |t_s| t_s >= 2.5);
    let before_ml = delivered_ml(&servo);

    let rest = doser.plan(Phase::known(servo.angle_rad), &Request::new(25.0 - before_ml, cruise))?;
    follow(&mut servo, &rest, |_| false);
    Ok(format!(
        "stopped at 2.500 s, stood at {stood_s:.3} s: {before_ml:.2} mL; with the rest {:.2} mL",
        delivered_ml(&servo)
    ))
}

#[allow(clippy::print_stdout, reason = "an example shows its result")]
fn main() -> Result<(), PlanError> {
    println!("{}", report()?);
    Ok(())
}

#[test]
fn it_prints_what_was_delivered() {
    assert_eq!(
        report().as_deref(),
        Ok("stopped at 2.500 s, stood at 2.544 s: 12.40 mL; with the rest 25.00 mL")
    );
}
