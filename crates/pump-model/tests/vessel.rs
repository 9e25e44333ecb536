//! The volume that a vessel receives, against sums over fine samples and the figures of an independent computation.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use pump_model::{BackFlow, ExactRun, Leg, Line, LineState, Port, Pump, VesselRun};

/// Legs of a motion from `start_rad` over `turn_rad` at `speed_rad_s`, with ramps of `ramp_rad_s2`.
fn legs(start_rad: f64, turn_rad: f64, speed_rad_s: f64, ramp_rad_s2: f64) -> ([Leg; 3], f64) {
    let direction = turn_rad.signum();
    let speed = speed_rad_s.min((turn_rad.abs() * ramp_rad_s2).sqrt());
    let (ramp_s, ramp_rad) = (speed / ramp_rad_s2, 0.5 * speed * speed / ramp_rad_s2);
    let cruise_s = (turn_rad.abs() - 2.0 * ramp_rad) / speed;
    let leg = |start_s, duration_s, turned_rad: f64, speed_rad_s: f64, acceleration_rad_s2: f64| Leg {
        start_s,
        duration_s,
        angle_rad: start_rad + direction * turned_rad,
        speed_rad_s: direction * speed_rad_s,
        acceleration_rad_s2: direction * acceleration_rad_s2,
    };
    let last_s = ramp_s + cruise_s;
    let legs = [
        leg(0.0, ramp_s, 0.0, 0.0, ramp_rad_s2),
        leg(ramp_s, cruise_s, ramp_rad, speed, 0.0),
        leg(last_s, ramp_s, ramp_rad + speed * cruise_s, speed, -ramp_rad_s2),
    ];
    (legs, last_s + ramp_s)
}

fn back_flow(pump: &Pump, legs: [Leg; 3], end_s: f64, is_forward: bool) -> BackFlow {
    let run = ExactRun::from_rest(pump, Port::Outlet, legs);
    VesselRun::new(run, is_forward).back_flow_to_rest(end_s).unwrap()
}

/// Sums the samples of the line's flow by the trapezoidal rule.
fn summed(pump: &Pump, legs: [Leg; 3], end_s: f64, is_forward: bool) -> BackFlow {
    let (dt_s, direction) = (2e-6, if is_forward { 1.0 } else { -1.0 });
    let count = ((end_s + 2.0) / dt_s) as usize;
    let flows = ExactRun::from_rest(pump, Port::Outlet, legs).every(dt_s).map(|state| state.flow_ml_s);
    let (mut received, mut most, mut taken, mut last) = (0.0_f64, 0.0_f64, 0.0_f64, 0.0_f64);
    for flow in flows.take(count) {
        let change = 0.5 * dt_s * direction * (flow + last);
        (received, last) = (received + change, flow);
        most = most.max(received);
        taken += (-change).max(0.0);
    }
    BackFlow { backflow_ml: most - received, reverse_flow_ml: taken }
}

#[test]
fn a_vessel_receives_the_sum_of_the_lines_flow() {
    let pump = Pump::three_roller();
    for (start, turn, speed, ramp) in
        [(0.3, 1.4, 1.5, 500.0), (1.1, -1.9, 4.0, 500.0), (0.0, 3.0, 17.0, 100.0), (2.0, 0.2, 1.0, 20.0)]
    {
        let (legs, end_s) = legs(start, turn, speed, ramp);
        let exact = back_flow(&pump, legs, end_s, turn > 0.0);
        let sum = summed(&pump, legs, end_s, turn > 0.0);
        let case = format!("{start} {turn} {speed} {ramp}: {exact:?} {sum:?}");
        assert!((exact.backflow_ml - sum.backflow_ml).abs() < 2e-6, "{case}");
        assert!((exact.reverse_flow_ml - sum.reverse_flow_ml).abs() < 2e-6, "{case}");
        assert!(exact.backflow_ml > 1e-4 && exact.reverse_flow_ml >= exact.backflow_ml, "{case}");
    }
}

#[test]
fn a_vessel_receives_what_the_rollers_deliver_once_the_line_rests() {
    let pump = Pump::three_roller();
    for direction in [1.0, -1.0] {
        let (legs, end_s) = legs(0.4, direction * 2.5, 3.0, 500.0);
        let mut run = VesselRun::new(ExactRun::from_rest(&pump, Port::Outlet, legs), direction > 0.0);
        run.go_to(end_s + 5.0);
        let curve = pump.outlet_curve();
        let rollers_ml = direction * (curve.volume_ml(0.4 + direction * 2.5) - curve.volume_ml(0.4));
        assert!((run.received_ml() - rollers_ml).abs() < 1e-9, "{} {rollers_ml}", run.received_ml());
    }
}

/// An independent computation has 63.6 uL and 0.15 mL for 1 mL at 5 mL/s, 207 uL for 3 mL at 15 mL/s, at
/// 500 rad/s² and the worst start angle. Ramps of 20 rad/s² leave a sixth and less.
#[test]
fn back_flow_is_that_of_an_independent_computation() {
    let pump = Pump::three_roller();
    let worst = |volume_ml: f64, rate_ml_s: f64, ramp_rad_s2: f64, angles: u32| {
        (0..angles).fold(BackFlow::default(), |worst, n| {
            let start = pump.pitch_rad() * f64::from(n) / f64::from(angles);
            let curve = pump.outlet_curve();
            let end = curve.angle_rad(curve.volume_ml(start) + volume_ml);
            let speed = rate_ml_s / (pump.revolution_ml() / core::f64::consts::TAU);
            let (legs, end_s) = legs(start, end - start, speed, ramp_rad_s2);
            worst.worst(back_flow(&pump, legs, end_s, true))
        })
    };
    let small = worst(1.0, 5.0, 500.0, 720);
    assert!((small.backflow_ml - 0.0636).abs() < 0.001, "{small:?}");
    assert!((small.reverse_flow_ml - 0.15).abs() < 0.01, "{small:?}");
    let large = worst(3.0, 15.0, 500.0, 720);
    assert!((large.backflow_ml - 0.207).abs() < 0.003, "{large:?}");
    assert!(worst(1.0, 5.0, 20.0, 72).backflow_ml < small.backflow_ml / 5.0);
    assert!(worst(3.0, 15.0, 20.0, 72).backflow_ml < large.backflow_ml / 10.0);
}

#[test]
fn a_line_that_never_rests_is_refused() {
    let pump = Pump::three_roller();
    let swinging = Line { resistance_kpa_s_ml: 0.0, ..*pump.outlet() };
    let pump = Pump::new(*pump.geometry(), *pump.roller_volume(), *pump.inlet(), swinging).unwrap();
    let (legs, end_s) = legs(0.0, 1.0, 2.0, 100.0);
    let run = ExactRun::new(&pump, Port::Outlet, legs, LineState::AT_REST);
    VesselRun::new(run, true).back_flow_to_rest(end_s).unwrap_err();
}
