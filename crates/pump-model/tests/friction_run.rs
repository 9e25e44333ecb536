//! Claims about runs with a hose's friction: the Jacobian, an independent solver, the linear limit.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use pump_model::circuit::{Circuit, Lumped, NoFlow};
use pump_model::integrator::Ode;
use pump_model::{
    ExactRun, Fluid, Friction, Geometry, Hose, IntegrationError, Leg, Line, LineState, Port, PortRun, Pump,
    RollerVolume, Variant,
};

/// Hose of McIntyre et al. as far as it is known.
const HOSE: Hose = Hose {
    bore_radius_mm: 5.0,
    outer_radius_mm: 7.0,
    length_mm: 331.0,
    modulus_mpa: 3.5,
    poisson_ratio: 0.5,
    minor_loss: 5.75,
};

fn water() -> Fluid {
    Fluid::water(25.0).unwrap()
}

fn pump_with(line: Line) -> Pump {
    let geometry = Geometry::published(3, Variant::Measured);
    Pump::new(geometry, RollerVolume::from_drawing(&geometry).unwrap(), line, line).unwrap()
}

fn rpm(speed: f64) -> f64 {
    speed * core::f64::consts::TAU / 60.0
}

#[test]
fn the_jacobian_is_the_derivative_of_the_right_hand_side() {
    let line = HOSE.line(&water(), 88.637, 35.0).unwrap();
    let friction = HOSE.friction(&water()).unwrap();
    for port in [Port::Inlet, Port::Outlet] {
        let model = Lumped::new(&line, friction, port);
        let circuit = Circuit::new(model, port, NoFlow);
        for y in [[5.0, 200.0], [-3.0, -40.0], [1.0, 16.0], [0.0, 0.5]] {
            let jacobian: [[f64; 2]; 2] = circuit.jacobian(0.0, &y);
            let largest = jacobian.as_flattened().iter().fold(0.0_f64, |most, entry| most.max(entry.abs()));
            for column in 0..2 {
                let h = 1e-6 * y[column].abs().max(1.0);
                let (mut more, mut less) = (y, y);
                more[column] += h;
                less[column] -= h;
                let (above, below) = (circuit.derivative(0.0, &more), circuit.derivative(0.0, &less));
                for row in 0..2 {
                    let error = ((above[row] - below[row]) / (2.0 * h) - jacobian[row][column]).abs();
                    assert!(error < 1e-5 * largest, "{error} at {y:?} of {jacobian:?}");
                }
            }
        }
    }
}

/// Runge's classic method with equal steps, which knows nothing of edges. They cost it 1e-6 mL/s at 160,000
/// steps and four times that at half as many.
fn classic(pump: &Pump, friction: &Friction, speed_rad_s: f64, end_s: f64, steps: u32) -> [f64; 2] {
    let line = pump.outlet();
    let derivative = |t: f64, [p, q]: [f64; 2]| {
        let flow = pump.outlet_curve().flow_ml_rad(speed_rad_s * t) * speed_rad_s;
        [(flow - q) / line.compliance_ml_kpa, (p - friction.drop_kpa(q)) / line.inertance_kpa_s2_ml]
    };
    let h = end_s / f64::from(steps);
    let plus = |y: [f64; 2], k: [f64; 2], by: f64| [y[0] + by * k[0], y[1] + by * k[1]];
    let mut y = [0.0; 2];
    for n in 0..steps {
        let t = f64::from(n) * h;
        let k1 = derivative(t, y);
        let k2 = derivative(t + 0.5 * h, plus(y, k1, 0.5 * h));
        let k3 = derivative(t + 0.5 * h, plus(y, k2, 0.5 * h));
        let k4 = derivative(t + h, plus(y, k3, h));
        for (n, y) in y.iter_mut().enumerate() {
            *y += h / 6.0 * (k1[n] + 2.0 * k2[n] + 2.0 * k3[n] + k4[n]);
        }
    }
    y
}

#[test]
fn an_independent_solver_finds_the_same_pressures() {
    let pump = pump_with(HOSE.line(&water(), 88.637, 0.0).unwrap());
    let friction = HOSE.friction(&water()).unwrap();
    for (speed_rpm, end_s) in [(20.0, 0.7), (100.0, 0.5), (300.0, 0.3)] {
        let speed = rpm(speed_rpm);
        let legs = [Leg::constant_speed(0.0, speed)];
        let start = LineState::AT_REST;
        let mut run =
            PortRun::<_, 2, _>::with_friction(&pump, friction, Port::Outlet, legs, start, 1e-10).unwrap();
        let found = run.run_to(end_s).unwrap();
        let [p, q] = classic(&pump, &friction, speed, end_s, 160_000);
        assert!(
            (found.above_reservoir_kpa - p).abs() < 2e-6 && (found.flow_ml_s - q).abs() < 2e-6,
            "{found:?} for {p} {q} at {speed_rpm}"
        );
    }
}

#[test]
fn laminar_flow_is_the_linear_line_and_turbulent_flow_is_not() {
    let water = water();
    let smooth = Hose { minor_loss: 0.0, ..HOSE };
    let oil = Fluid { viscosity_mpa_s: 200.0, ..water };
    let difference = |hose: &Hose, fluid: &Fluid| {
        // The line has the R of slow flow; for oil all flow is below a Reynolds number of 100.
        let pump = pump_with(hose.line(fluid, 88.637, 0.0).unwrap());
        let legs = || [Leg::constant_speed(0.0, rpm(100.0))];
        let start = LineState::AT_REST;
        let friction = hose.friction(fluid).unwrap();
        let mut rough =
            PortRun::<_, 2, _>::with_friction(&pump, friction, Port::Outlet, legs(), start, 1e-10).unwrap();
        let linear = ExactRun::from_rest(&pump, Port::Outlet, legs()).extremes(1.0);
        let rough = rough.extremes(1.0).unwrap();
        (rough.max_kpa - linear.max_kpa).abs().max((rough.min_kpa - linear.min_kpa).abs())
    };
    assert!(difference(&smooth, &oil) < 1e-6);
    assert!(difference(&HOSE, &water) > 1.0);
}

#[test]
fn radaus_method_refuses_what_is_not_linear() {
    let pump = pump_with(HOSE.line(&water(), 88.637, 0.0).unwrap());
    let friction = HOSE.friction(&water()).unwrap();
    let legs = [Leg::constant_speed(0.0, 10.0)];
    let start = LineState::AT_REST;
    let run = PortRun::<_, 2, _>::with_friction(&pump, friction, Port::Outlet, legs, start, 1e-6).unwrap();
    assert_eq!(run.with_radau().unwrap_err(), IntegrationError::NotLinear);
}

#[test]
fn a_released_line_only_loses_energy() {
    let line = HOSE.line(&water(), 88.637, 0.0).unwrap();
    let pump = pump_with(line);
    let friction = HOSE.friction(&water()).unwrap();
    let legs = [Leg::rest(0.0, 0.0)];
    let mut run = PortRun::<_, 2, _>::with_friction(
        &pump,
        friction,
        Port::Outlet,
        legs,
        LineState { above_reservoir_kpa: 20.0, flow_ml_s: 0.0 },
        1e-9,
    )
    .unwrap();
    let energy = |y: LineState| {
        line.compliance_ml_kpa * y.above_reservoir_kpa.powi(2)
            + line.inertance_kpa_s2_ml * y.flow_ml_s.powi(2)
    };
    let mut last = energy(run.state());
    for n in 1..200 {
        let now = energy(run.run_to(f64::from(n) * 0.05).unwrap());
        assert!(now <= last * (1.0 + 1e-6), "{n}");
        last = now;
    }
    assert!(last < 1e-3 * line.compliance_ml_kpa * 400.0, "{last}");
}
