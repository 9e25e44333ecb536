//! Claims about pressures against the reference table and against an exact solution.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod exact;

use exact::{Exact, Linear};
use pump_model::{DEFAULT_TOLERANCE, ExactRun, Leg, Line, Port, PortRun, Pump};

fn rad_s(rpm: f64) -> f64 {
    rpm * core::f64::consts::TAU / 60.0
}

/// Reference table: rollers, r/min, then max, min, mean of P_in and P_out, kPa.
///
/// The pressures are those of the periodic steady state, with true extremes, computed independently to 1e-4
/// kPa.
const STEADY: [(u32, f64, [f64; 6]); 6] = [
    (3, 50.0, [90.5879, 84.8782, 86.6686, 93.3473, 87.8604, 90.6054]),
    (3, 100.0, [95.3347, 73.7963, 84.7002, 104.5105, 83.5685, 92.5738]),
    (3, 150.0, [100.3254, 61.4112, 82.7318, 116.2201, 77.4455, 94.5422]),
    (2, 50.0, [90.5578, 84.8847, 86.4742, 93.3369, 87.8931, 90.7998]),
    (2, 100.0, [96.3518, 73.0388, 84.3114, 105.3520, 82.4483, 92.9626]),
    (2, 150.0, [99.8906, 61.0270, 82.1486, 116.6113, 78.3548, 95.1254]),
];

fn table_row(pump: &Pump, rpm: f64) -> [f64; 6] {
    let steady = pump.steady_state(rad_s(rpm)).unwrap();
    [
        steady.inlet.max_kpa,
        steady.inlet.min_kpa,
        steady.inlet_mean_kpa,
        steady.outlet.max_kpa,
        steady.outlet.min_kpa,
        steady.outlet_mean_kpa,
    ]
}

#[test]
fn steady_pressures_match_the_reference_table() {
    for (rollers, rpm, expected) in STEADY {
        let pump = if rollers == 3 { Pump::three_roller() } else { Pump::two_roller() };
        for (found, expected) in table_row(&pump, rpm).into_iter().zip(expected) {
            // The table has four decimals.
            assert!(
                (found - expected).abs() < 6e-5,
                "{rollers} rollers, {rpm} r/min: {found} for {expected}"
            );
        }
    }
}

#[test]
fn the_integrator_reaches_the_same_table_once_start_up_is_forgotten() {
    for (rollers, rpm, expected) in STEADY {
        let pump = if rollers == 3 { Pump::three_roller() } else { Pump::two_roller() };
        let motion = [Leg::constant_speed(0.0, rad_s(rpm))];
        let settled = |port| {
            let mut run = PortRun::<_, 2>::from_rest(&pump, port, motion, DEFAULT_TOLERANCE).unwrap();
            run.run_to(3.0).unwrap();
            run.extremes(3.0 + 60.0 / rpm).unwrap()
        };
        let (inlet, outlet) = (settled(Port::Inlet), settled(Port::Outlet));
        let found = [inlet.max_kpa, inlet.min_kpa, outlet.max_kpa, outlet.min_kpa];
        for (found, n) in found.into_iter().zip([0, 1, 3, 4]) {
            assert!((found - expected[n]).abs() < 3e-4, "{rollers}, {rpm}: {found} for {}", expected[n]);
        }
    }
}

#[test]
fn start_up_reaches_the_reference_extremes() {
    let pump = Pump::three_roller();
    let motion = [Leg::constant_speed(0.0, rad_s(100.0))];
    let integrated = |port| {
        PortRun::<_, 2>::from_rest(&pump, port, motion, DEFAULT_TOLERANCE).unwrap().extremes(10.0).unwrap()
    };
    let exact = |port| ExactRun::from_rest(&pump, port, motion).extremes(10.0);
    for [inlet, outlet] in
        [[exact(Port::Inlet), exact(Port::Outlet)], [integrated(Port::Inlet), integrated(Port::Outlet)]]
    {
        for (found, expected) in [
            (inlet.min_kpa, 71.725),
            (inlet.max_kpa, 98.109),
            (outlet.min_kpa, 78.519),
            (outlet.max_kpa, 108.568),
        ] {
            assert!((found - expected).abs() < 6e-4, "{found} for {expected}");
        }
    }
}

/// Returns the equations of the pump's own line: C dp/dt = s (Q - q), L dq/dt = s p - R q.
fn built_in(line: &Line, port: Port) -> Linear<2> {
    let s = if port == Port::Outlet { 1.0 } else { -1.0 };
    let Line { resistance_kpa_s_ml: r, compliance_ml_kpa: c, inertance_kpa_s2_ml: l, .. } = *line;
    Linear { matrix: [[0.0, -s / c], [s / l, -r / l]], input: [1.0 / c, 0.0] }
}

/// Returns the largest pressure error over 10 s from rest, sampled every millisecond, kPa.
fn benchmark_error_kpa(tolerance: f64) -> f64 {
    let pump = Pump::three_roller();
    let speed_rad_s = rad_s(100.0);
    let motion = [Leg::constant_speed(0.0, speed_rad_s)];
    let mut worst = 0.0_f64;
    for port in [Port::Inlet, Port::Outlet] {
        let exact = Exact { rollers: 3, speed_rad_s, outlet: port == Port::Outlet };
        let line = built_in(pump.line(port), port);
        let mut run = PortRun::<_, 2>::from_rest(&pump, port, motion, tolerance).unwrap();
        // The exact solution is summed pitch by pitch; the samples of a pitch continue from its start.
        let period = 60.0 / 100.0 / 3.0;
        let mut start = [0.0, 0.0];
        for pitch in 0..50 {
            for n in 1..=200 {
                let inside = f64::from(n) * 1e-3;
                let expected = exact.follow::<2, 7>(&line, inside, start);
                let found = run.at(f64::from(pitch) * period + inside).unwrap();
                worst = worst.max((found.above_reservoir_kpa - expected[0]).abs());
            }
            start = exact.follow::<2, 7>(&line, period, start);
        }
    }
    worst
}

#[test]
fn default_tolerance_gives_1e_4_kpa() {
    let error = benchmark_error_kpa(DEFAULT_TOLERANCE);
    assert!(error < 1e-4, "{error:e} kPa");
}

#[test]
fn tolerance_1e_9_gives_1e_6_kpa() {
    let error = benchmark_error_kpa(1e-9);
    assert!(error < 1e-6, "{error:e} kPa");
}

#[test]
fn periodic_state_of_the_exact_solution_gives_the_same_extremes() {
    let exact = Exact { rollers: 3, speed_rad_s: rad_s(100.0), outlet: true };
    let line = built_in(&Line::PUBLISHED, Port::Outlet);
    let start = exact.periodic::<2, 7>(&line);
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for n in 1..=2000 {
        let pressure = exact.follow::<2, 7>(&line, f64::from(n) * 1e-4, start)[0];
        low = low.min(pressure);
        high = high.max(pressure);
    }
    let steady = Pump::three_roller().steady_state(rad_s(100.0)).unwrap();
    // Sampling every 0.1 ms misses a peak by 1e-4 kPa at most.
    assert!((steady.outlet.max_kpa - 88.637 - high).abs() < 1e-4);
    assert!((steady.outlet.min_kpa - 88.637 - low).abs() < 1e-4);
}
