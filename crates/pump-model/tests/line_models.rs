//! Claims about lines that a user models: two cells against an exact solution, the built-in line as a model.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod exact;

use exact::{Exact, Linear};
use pump_model::circuit::{LineModel, LineRun, Lumped};
use pump_model::units::rad_s;
use pump_model::{Leg, Line, LineState, ModelError, Port, PortRun, Pump};

/// A line in two cells, each with C, R and L; the states are p, q of the first and p, q of the second.
struct TwoCells(Linear<4>);

impl TwoCells {
    fn new(first: Line, second: Line) -> Self {
        let [c, d] = [first, second].map(|line| 1.0 / line.compliance_ml_kpa);
        let [l, m] = [first, second].map(|line| 1.0 / line.inertance_kpa_s2_ml);
        let (r, s) = (first.resistance_kpa_s_ml * l, second.resistance_kpa_s_ml * m);
        let matrix = [[0.0, -c, 0.0, 0.0], [l, -r, -l, 0.0], [0.0, d, 0.0, -d], [0.0, 0.0, m, -s]];
        Self(Linear { matrix, input: [c, 0.0, 0.0, 0.0] })
    }
}

impl LineModel<4> for TwoCells {
    fn derivative(&self, inflow_ml_s: f64, state: &[f64; 4]) -> [f64; 4] {
        core::array::from_fn(|n| {
            let row: f64 = self.0.matrix[n].iter().zip(state).map(|(a, y)| a * y).sum();
            row + self.0.input[n] * inflow_ml_s
        })
    }
    fn jacobian(&self, _inflow_ml_s: f64, _state: &[f64; 4]) -> [[f64; 4]; 4] {
        self.0.matrix
    }
    fn per_inflow(&self, _inflow_ml_s: f64, _state: &[f64; 4]) -> [f64; 4] {
        self.0.input
    }
    fn scale(&self) -> [f64; 4] {
        [1.0, 4.0, 1.0, 4.0]
    }
    fn is_linear(&self) -> bool {
        true
    }
}

/// Half of the published line, then a softer and heavier half.
fn two_cells() -> TwoCells {
    let Line { resistance_kpa_s_ml: r, compliance_ml_kpa: c, inertance_kpa_s2_ml: l, .. } = Line::PUBLISHED;
    let half = |factor: f64| Line {
        resistance_kpa_s_ml: 0.5 * r,
        compliance_ml_kpa: 0.5 * c * factor,
        inertance_kpa_s2_ml: 0.5 * l * factor,
        ..Line::PUBLISHED
    };
    TwoCells::new(half(1.0), half(1.7))
}

fn exact(outlet: bool) -> Exact {
    Exact { rollers: 3, speed_rad_s: rad_s(80.0), outlet }
}

#[test]
fn two_cells_follow_the_matrix_exponential() {
    let pump = Pump::three_roller();
    let cells = two_cells();
    let start = [3.0, -2.0, 1.0, 5.0];
    for (port, outlet) in [(Port::Inlet, false), (Port::Outlet, true)] {
        let motion = [Leg::constant_speed(0.0, rad_s(80.0))];
        let mut run = LineRun::new(&pump, port, &cells, motion, start, 1e-10).unwrap();
        let mut radau = run.clone().with_radau().unwrap();
        for n in 1..=60 {
            let t = 0.013 * f64::from(n);
            let (found, by_radau) = (run.at(t).unwrap(), radau.at(t).unwrap());
            let expected = exact(outlet).follow::<4, 9>(&two_cells().0, t, start);
            for ((found, by_radau), expected) in found.into_iter().zip(by_radau).zip(expected) {
                assert!((found - expected).abs() < 1e-7, "{port:?} at {t} s: {found} for {expected}");
                assert!((by_radau - expected).abs() < 1e-7, "{port:?} at {t} s: {by_radau} for {expected}");
            }
        }
        let [steps, by_radau] = [run, radau].map(|run| run.statistics().steps);
        assert!(7 * by_radau < steps, "{by_radau} steps of Radau's method, {steps} of RODAS5P");
    }
}

#[test]
fn the_periodic_state_of_two_cells_is_the_exact_one() {
    let pump = Pump::three_roller();
    for (port, outlet) in [(Port::Inlet, false), (Port::Outlet, true)] {
        let found = pump.periodic_line(port, two_cells(), rad_s(80.0)).unwrap();
        let expected = exact(outlet).periodic::<4, 9>(&two_cells().0);
        for (n, expected) in expected.into_iter().enumerate() {
            let off = (found.state[n] - expected) / two_cells().scale()[n];
            assert!(off.abs() < 2e-5, "{port:?}: {:?} has {expected} at {n}", found.state);
        }
        let period_s = pump.pitch_rad() / rad_s(80.0);
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for n in 0..400 {
            let t = period_s * f64::from(n) / 400.0;
            let [kpa, ..] = exact(outlet).follow::<4, 9>(&two_cells().0, t, expected);
            (low, high) = (low.min(kpa), high.max(kpa));
        }
        let reservoir_kpa = pump.line(port).reservoir_kpa;
        let [low, high] = [low, high].map(|kpa| kpa + reservoir_kpa);
        // Samples come within 1e-2 kPa of a turn.
        assert!((found.pressure.min_kpa - low).abs() < 1e-2 && found.pressure.min_kpa < low + 2e-5);
        assert!((found.pressure.max_kpa - high).abs() < 1e-2 && found.pressure.max_kpa > high - 2e-5);
        // The reservoir takes what the rollers push: the mean falls over both resistances.
        let sign = if outlet { 1.0 } else { -1.0 };
        let drop_kpa = Line::PUBLISHED.resistance_kpa_s_ml * pump.average_flow_ml_s(rad_s(80.0));
        assert!((found.mean_kpa - (reservoir_kpa + sign * drop_kpa)).abs() < 1e-4, "{}", found.mean_kpa);
    }
}

#[test]
fn the_built_in_line_as_a_model_has_the_bits_of_a_port_run() {
    let pump = Pump::three_roller();
    for port in [Port::Inlet, Port::Outlet] {
        let line = pump.line(port);
        let model = Lumped::new(line, pump_model::circuit::Linear::of(line), port);
        let motion = || [Leg::constant_speed(0.0, 10.0)];
        let mut modelled = LineRun::<_, _, 2>::new(&pump, port, model, motion(), [1.0, 2.0], 1e-6).unwrap();
        let start = LineState { above_reservoir_kpa: 1.0, flow_ml_s: 2.0 };
        let mut built_in = PortRun::<_, 2>::new(&pump, port, motion(), start, 1e-6).unwrap();
        for n in 1..500 {
            let t = 2e-3 * f64::from(n);
            let (modelled, built_in) = (modelled.at(t).unwrap(), built_in.at(t).unwrap());
            let bits = [built_in.above_reservoir_kpa, built_in.flow_ml_s].map(f64::to_bits);
            assert_eq!(modelled.map(f64::to_bits), bits, "{port:?} at {t} s");
        }
        assert_eq!(modelled.statistics(), built_in.statistics());
        assert_eq!(modelled.extremes(2.0), built_in.extremes(2.0));
    }
}

/// A total grows for ever, and neither hinders the periodic state nor has an error relative to itself.
#[test]
fn a_total_need_not_repeat() {
    let pump = Pump::three_roller();
    let line = pump.outlet();
    let model = || Lumped::new(line, pump_model::circuit::Linear::of(line), Port::Outlet);
    let without = pump.periodic_line::<2>(Port::Outlet, model(), 9.0).unwrap();
    let with = pump.periodic_line::<3>(Port::Outlet, model(), 9.0).unwrap();
    assert!((with.pressure.max_kpa - without.pressure.max_kpa).abs() < 1e-5);
    assert!(with.state[2] > 10.0, "{:?}", with.state);
}

/// A model whose scale is not positive.
struct Unscaled<'a>(&'a TwoCells, f64);

impl LineModel<4> for Unscaled<'_> {
    fn derivative(&self, inflow_ml_s: f64, state: &[f64; 4]) -> [f64; 4] {
        self.0.derivative(inflow_ml_s, state)
    }
    fn jacobian(&self, inflow_ml_s: f64, state: &[f64; 4]) -> [[f64; 4]; 4] {
        self.0.jacobian(inflow_ml_s, state)
    }
    fn per_inflow(&self, inflow_ml_s: f64, state: &[f64; 4]) -> [f64; 4] {
        self.0.per_inflow(inflow_ml_s, state)
    }
    fn scale(&self) -> [f64; 4] {
        [1.0, self.1, 1.0, 1.0]
    }
}

#[test]
fn a_scale_by_which_an_error_means_nothing_is_refused() {
    let (pump, cells) = (Pump::three_roller(), two_cells());
    for scale in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let model = || Unscaled(&cells, scale);
        let motion = [Leg::constant_speed(0.0, 1.0)];
        assert!(LineRun::new(&pump, Port::Outlet, model(), motion, [0.0; 4], 1e-6).is_err(), "{scale}");
        let refused = pump.periodic_line(Port::Outlet, model(), 1.0).unwrap_err();
        assert!(matches!(refused, ModelError::Integration(_)), "{scale}: {refused}");
    }
    assert!(pump.periodic_line(Port::Outlet, two_cells(), 0.0).is_err(), "rollers at rest");
}
