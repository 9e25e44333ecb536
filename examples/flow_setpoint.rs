//! Makes the pump a flow source, as in an electro-hydrostatic actuator. A flow that changes all the time
//! becomes a speed of the rotor, from the angle of its rollers. The usual conversion by the volume of a
//! revolution stands beside it.
//!
//! `cargo run --example flow_setpoint`

use pump_ctl::plan::{Motor, speed_for_flow};
use pump_model::Pump;

/// Period of the loop, s.
const PERIOD_S: f64 = 1e-3;

/// Flow that the actuator asks for at `t_s`, mL/s: 3 mL/s to and fro every 4 s.
fn set_point_ml_s(t_s: f64) -> f64 {
    3.0 * (core::f64::consts::TAU * 0.25 * t_s).sin()
}

/// Rotor that turns as fast as it is told, within the motor's limits.
struct Rotor {
    motor: Motor,
    angle_rad: f64,
    speed_rad_s: f64,
}

impl Rotor {
    /// Turns for one period at the speed nearest to the wanted one.
    fn turn(&mut self, wanted_rad_s: f64) {
        let change_rad_s = self.motor.max_acceleration_rad_s2 * PERIOD_S;
        let limit_rad_s = self.motor.max_speed_rad_s;
        self.speed_rad_s += (wanted_rad_s - self.speed_rad_s).clamp(-change_rad_s, change_rad_s);
        self.speed_rad_s = self.speed_rad_s.clamp(-limit_rad_s, limit_rad_s);
        self.angle_rad += self.speed_rad_s * PERIOD_S;
    }
}

/// Returns the root of the mean square error of the flow over 8 s, mL/s. `speed_rad_s` makes a speed of a
/// flow, mL/s, and the rotor's angle, rad.
fn rms_error_ml_s(pump: &Pump, speed_rad_s: impl Fn(f64, f64) -> f64) -> f64 {
    const PERIODS: u32 = 8000;
    let curve = pump.outlet_curve();
    let motor = Motor::new(12_800.0, 17.8, 500.0);
    let mut rotor = Rotor { motor, angle_rad: 0.0, speed_rad_s: 0.0 };
    let mut sum = 0.0;
    for n in 0..PERIODS {
        let asked_ml_s = set_point_ml_s(f64::from(n) * PERIOD_S);
        let before_ml = curve.volume_ml(rotor.angle_rad);
        rotor.turn(speed_rad_s(asked_ml_s, rotor.angle_rad));
        let obtained_ml_s = (curve.volume_ml(rotor.angle_rad) - before_ml) / PERIOD_S;
        sum += (obtained_ml_s - asked_ml_s).powi(2);
    }
    (sum / f64::from(PERIODS)).sqrt()
}

fn report() -> String {
    let pump = Pump::three_roller();
    let curve = pump.outlet_curve();
    let by_angle = rms_error_ml_s(&pump, |ml_s, angle_rad| curve.speed_for_flow(ml_s, angle_rad));
    let by_mean = rms_error_ml_s(&pump, |ml_s, _| speed_for_flow(&pump, ml_s));
    format!(
        "rms error of the flow: {by_angle:.3} mL/s by the roller angle, {by_mean:.3} mL/s by mL per revolution"
    )
}

#[allow(clippy::print_stdout, reason = "an example shows its result")]
fn main() {
    println!("{}", report());
}

#[test]
fn it_prints_both_errors() {
    assert_eq!(
        report(),
        "rms error of the flow: 0.009 mL/s by the roller angle, 1.183 mL/s by mL per revolution"
    );
}
