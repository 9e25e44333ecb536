//! Derivatives of the exact solution, against central differences with Richardson extrapolation and against complex
//! steps of an independent integration.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod complex;

use complex::{Complex, Parameters, pressures_by_steps};
use proptest::prelude::*;
use pump_model::{
    ExactRun, Geometry, Leg, Line, LineState, Port, Pump, RollerVolume, SensitiveColumns, SensitiveRun,
    SensitiveState, SensitivityParameter, Variant,
};

const PORTS: [Port; 2] = [Port::Inlet, Port::Outlet];
const RESERVOIR_KPA: f64 = 88.637;

fn line(resistance: f64, compliance: f64, inertance: f64) -> Line {
    Line {
        resistance_kpa_s_ml: resistance,
        compliance_ml_kpa: compliance,
        inertance_kpa_s2_ml: inertance,
        reservoir_kpa: RESERVOIR_KPA,
    }
}

/// Lines that swing, that only just do not swing, that creep, and that nothing damps.
fn lines() -> [Line; 5] {
    let critical = 2.0 * (0.0042_f64 / 0.0361).sqrt();
    [
        Line::PUBLISHED,
        line(critical, 0.0361, 0.0042),
        line(3.0, 0.05, 0.002),
        line(0.0, 0.03, 0.005),
        line(40.0, 0.5, 1e-4),
    ]
}

fn pump(rollers: u32, line: Line, roller_ml: f64) -> Pump {
    let roller = RollerVolume::measured().unwrap().scaled_to(roller_ml).unwrap();
    Pump::new(Geometry::published(rollers, Variant::Measured), roller, line, line).unwrap()
}

/// Motion that turns the rollers on by an angle.
fn turned(legs: &[Leg], off_rad: f64) -> Vec<Leg> {
    legs.iter().map(|leg| leg.beside(off_rad)).collect()
}

/// Motion at constant speed, and one that speeds up, cruises, turns back and stands.
fn motions(start_rad: f64, speed_rad_s: f64) -> [Vec<Leg>; 2] {
    let mut legs: Vec<Leg> = Vec::new();
    for (duration_s, acceleration) in [(0.1, 10.0), (0.35, 0.0), (0.4, -5.0), (0.15, 20.0 / 3.0)] {
        let last = legs.last().copied();
        legs.push(Leg {
            start_s: last.map_or(0.0, |leg| leg.end_s()),
            duration_s,
            angle_rad: last.map_or(start_rad, |leg| leg.end_angle_rad()),
            speed_rad_s: last.map_or(0.0, |leg| leg.speed_at(leg.end_s())),
            acceleration_rad_s2: acceleration * speed_rad_s,
        });
    }
    [vec![Leg::constant_speed(start_rad, speed_rad_s)], legs]
}

/// Start of a run: from a state that is given, or from the periodic one.
#[derive(Clone, Copy, Debug)]
enum Start {
    Given(LineState),
    Steady,
}

/// A run that is to be differentiated.
#[derive(Clone, Debug)]
struct Case {
    rollers: u32,
    line: Line,
    roller_ml: f64,
    port: Port,
    legs: Vec<Leg>,
    start: Start,
}

impl Case {
    fn pump(&self) -> Pump {
        pump(self.rollers, self.line, self.roller_ml)
    }

    /// Returns the states at `times_s` where a parameter is `change` larger, without derivatives.
    fn states(&self, parameter: SensitivityParameter, change: f64, times_s: &[f64]) -> Vec<[f64; 2]> {
        let mut case = self.clone();
        let mut off_rad = 0.0;
        match parameter {
            SensitivityParameter::Resistance => case.line.resistance_kpa_s_ml += change,
            SensitivityParameter::Compliance => case.line.compliance_ml_kpa += change,
            SensitivityParameter::Inertance => case.line.inertance_kpa_s2_ml += change,
            SensitivityParameter::StartAngle => off_rad = change,
            SensitivityParameter::RollerVolume => case.roller_ml += change,
            other => panic!("no such parameter: {other:?}"),
        }
        let pump = case.pump();
        let legs = turned(&case.legs, off_rad);
        let (speed, angle) = (legs[0].speed_rad_s, legs[0].angle_rad);
        let state = match case.start {
            Start::Given(state) => state,
            Start::Steady => {
                let at_0 = pump.periodic_state(case.port, speed).unwrap();
                let turned_rad = (angle * speed.signum()).rem_euclid(pump.pitch_rad());
                let whole = [Leg::constant_speed(0.0, speed)];
                ExactRun::new(&pump, case.port, whole, at_0).at(turned_rad / speed.abs())
            }
        };
        let mut run = ExactRun::new(&pump, case.port, legs, state);
        let pair = |state: LineState| [state.above_reservoir_kpa, state.flow_ml_s];
        times_s.iter().map(|t| pair(run.at(*t))).collect()
    }

    /// Returns the derivatives of the states by central differences, whose error is of the fourth order.
    fn differences(&self, parameter: SensitivityParameter, times_s: &[f64]) -> Vec<[f64; 2]> {
        let size = self.size(parameter);
        let central = |step: f64| {
            let (more, less) =
                (self.states(parameter, step, times_s), self.states(parameter, -step, times_s));
            more.into_iter()
                .zip(less)
                .map(move |(more, less)| [0, 1].map(|n| (more[n] - less[n]) / (2.0 * step)))
        };
        let (wide, narrow) = (central(4e-4 * size), central(2e-4 * size));
        wide.zip(narrow).map(|(wide, narrow)| [0, 1].map(|n| (4.0 * narrow[n] - wide[n]) / 3.0)).collect()
    }

    /// Size of a parameter, by which its change is small or large.
    fn size(&self, parameter: SensitivityParameter) -> f64 {
        match parameter {
            SensitivityParameter::Resistance => self.line.resistance_kpa_s_ml.max(0.01),
            SensitivityParameter::Compliance => self.line.compliance_ml_kpa,
            SensitivityParameter::Inertance => self.line.inertance_kpa_s2_ml,
            SensitivityParameter::StartAngle => 0.3,
            _ => 1.0,
        }
    }

    fn run<'a>(&self, pump: &'a Pump) -> SensitiveRun<'a, std::vec::IntoIter<Leg>> {
        let start = match self.start {
            Start::Given(state) => SensitiveState::fixed(state),
            Start::Steady => {
                let (speed, angle) = (self.legs[0].speed_rad_s, self.legs[0].angle_rad);
                SensitiveState::steady(pump, self.port, speed, angle).unwrap()
            }
        };
        SensitiveRun::new(pump, self.port, self.legs.clone(), start)
    }

    /// Asserts that all derivatives are those of the differences, to `tolerance` of the largest.
    fn check(&self, times_s: &[f64], tolerance: f64) {
        let pump = self.pump();
        let mut run = self.run(&pump);
        let exact: Vec<SensitiveState> = times_s.iter().map(|t| run.at(*t)).collect();
        let plain = self.states(SensitivityParameter::Resistance, 0.0, times_s);
        let scale =
            plain.iter().fold([1e-3_f64; 2], |most, state| [0, 1].map(|n| most[n].max(state[n].abs())));
        for (sensitive, plain) in exact.iter().zip(&plain) {
            let state = [sensitive.state.above_reservoir_kpa, sensitive.state.flow_ml_s];
            for n in 0..2 {
                assert!((state[n] - plain[n]).abs() <= 1e-11 * scale[n], "{state:?} {plain:?}: {self:?}");
            }
        }
        for parameter in SensitivityParameter::ALL {
            if parameter == SensitivityParameter::Resistance && self.line.resistance_kpa_s_ml == 0.0 {
                // R cannot be less than 0. The complex steps cover it.
                continue;
            }
            let differences = self.differences(parameter, times_s);
            for ((sensitive, difference), t) in exact.iter().zip(differences).zip(times_s) {
                let found = [sensitive.pressure_by[parameter.index()], sensitive.flow_by[parameter.index()]];
                for n in 0..2 {
                    let error = (found[n] - difference[n]).abs();
                    let allowed = tolerance * (scale[n] / self.size(parameter)).max(difference[n].abs());
                    assert!(error <= allowed, "{parameter:?} at {t}: {found:?} {difference:?}, {self:?}");
                }
            }
        }
    }
}

#[test]
fn derivatives_are_the_limits_of_differences_on_every_kind_of_line() {
    let times_s = [0.0137, 0.0731, 0.1113, 0.3119, 0.6171, 0.8477, 0.9393, 1.4];
    for (n, line) in lines().into_iter().enumerate() {
        for (rollers, port) in [(3, Port::Outlet), (3, Port::Inlet), (2, Port::Inlet), (7, Port::Outlet)] {
            for legs in motions(0.31, if n % 2 == 0 { 9.7 } else { -6.3 }) {
                let start = Start::Given(LineState { above_reservoir_kpa: 3.0, flow_ml_s: -2.0 });
                let case = Case { rollers, line, roller_ml: 2.0, port, legs, start };
                case.check(&times_s, 1e-8);
            }
        }
    }
}

#[test]
fn a_periodic_state_carries_its_own_derivatives() {
    for (n, line) in lines().into_iter().enumerate().filter(|(n, _)| *n != 3) {
        for (rollers, port) in [(3, Port::Outlet), (3, Port::Inlet), (2, Port::Outlet)] {
            let legs = vec![Leg::constant_speed(5.2, if n % 2 == 0 { 7.1 } else { -12.3 })];
            let case = Case { rollers, line, roller_ml: 2.0, port, legs, start: Start::Steady };
            case.check(&[0.0, 0.0371, 0.1213, 0.8117], 1e-8);
        }
    }
}

#[test]
fn steady_derivatives_repeat_themselves_and_a_resonance_without_damping_is_refused() {
    let pump = Pump::three_roller();
    for port in PORTS {
        let [one, other] = [0.7, 0.7 + 3.0 * pump.pitch_rad()]
            .map(|angle| SensitiveState::steady(&pump, port, 8.0, angle).unwrap());
        for n in 0..SensitivityParameter::COUNT {
            assert!((one.pressure_by[n] - other.pressure_by[n]).abs() < 1e-9, "{port} {n}");
        }
        // By the angle, the pressure's rate of change over the speed.
        let legs = [Leg::constant_speed(0.7, 8.0)];
        let mut run = SensitiveRun::new(&pump, port, legs, one);
        let [before, after] = [0.01 - 1e-5, 0.01 + 1e-5].map(|t| run.at(t).state.above_reservoir_kpa);
        let by_angle = SensitiveState::steady(&pump, port, 8.0, 0.78).unwrap().pressure_by[3];
        assert!((by_angle - (after - before) / 2e-5 / 8.0).abs() < 1e-4, "{port}");
    }
    let undamped = pump.line(Port::Outlet);
    let undamped = Line { resistance_kpa_s_ml: 0.0, ..*undamped };
    let resonant = pump_of(undamped);
    let speed = undamped.natural_rad_s() / 3.0;
    assert!(SensitiveState::steady(&resonant, Port::Outlet, speed, 0.0).is_err());
    assert!(SensitiveState::steady(&resonant, Port::Outlet, 0.0, 0.0).is_err());
}

fn pump_of(line: Line) -> Pump {
    pump(3, line, 2.0)
}

#[test]
fn derivatives_by_the_line_are_those_of_complex_steps_of_an_independent_integration() {
    let times_s = [0.05, 0.23, 0.55, 0.9];
    for line in lines().into_iter().take(4) {
        let pump = pump_of(line);
        for (port, legs) in PORTS.into_iter().zip(motions(0.2, 10.0)) {
            let start = LineState { above_reservoir_kpa: -1.0, flow_ml_s: 4.0 };
            let mut run = SensitiveRun::new(&pump, port, legs.clone(), SensitiveState::fixed(start));
            let exact = times_s.map(|t| run.at(t));
            for n in 0..3 {
                let tiny = Complex { re: 0.0, im: 1e-30 };
                let mut parameters = Parameters::of(&line);
                parameters.0[n] = parameters.0[n].plus(tiny);
                let steps = pressures_by_steps(&pump, port, &legs, start, parameters, &times_s);
                let size =
                    [line.resistance_kpa_s_ml.max(0.1), line.compliance_ml_kpa, line.inertance_kpa_s2_ml][n];
                for (sensitive, step) in exact.iter().zip(steps) {
                    let (found, expected) = (sensitive.pressure_by[n], step.im / 1e-30);
                    let error = size * (found - expected).abs();
                    assert!(error < 2e-9, "{n}: {found} {expected}, error {error:e}, {line:?} {port}");
                    assert!((sensitive.state.above_reservoir_kpa - step.re).abs() < 1e-8);
                }
            }
        }
    }
}

#[test]
fn samples_at_equal_intervals_are_those_asked_one_by_one() {
    for line in lines() {
        let pump = pump_of(line);
        for port in PORTS {
            for legs in motions(0.0, 10.471_975_511_965_978) {
                let start = SensitiveState::fixed(LineState { above_reservoir_kpa: 1.0, flow_ml_s: 0.5 });
                let run = || SensitiveRun::new(&pump, port, legs.clone(), start);
                let (mut columns, mut flow, mut rate) = ([[0.0; 1201]; 6], [0.0; 1201], [0.0; 1201]);
                let [kpa, by_0, by_1, by_2, by_3, by_4] = &mut columns;
                let mut samples = run().every(1e-3);
                // Parts of any length make one row.
                let mut done = 0;
                for part in [1, 2, 7, 64, 331, 796] {
                    let place = done..done + part;
                    let by = [&mut *by_0, by_1, by_2, by_3, by_4];
                    samples.fill(SensitiveColumns {
                        kpa: &mut kpa[place.clone()],
                        kpa_by: by.map(|column| &mut column[place.clone()]),
                        flow_ml_rad: Some(&mut flow[place.clone()]),
                        rate_kpa_s: Some(&mut rate[place]),
                    });
                    done += part;
                }
                let mut single = run();
                let mut scale = [0.0_f64; 6];
                let mut worst = [0.0_f64; 6];
                for (n, next) in run().every(1e-3).take(1201).enumerate() {
                    let state = single.at(n as f64 * 1e-3);
                    let missed_ml_rad = (flow[n] - single.flow_ml_rad()).abs();
                    assert!(!(1e-11..=0.01).contains(&missed_ml_rad), "{n}: {missed_ml_rad}");
                    // C dP/dt is what the rollers push, and the line does not take.
                    let leg = legs.iter().rfind(|leg| leg.start_s <= n as f64 * 1e-3).unwrap();
                    let speed_rad_s =
                        if n as f64 * 1e-3 < leg.end_s() { leg.speed_at(n as f64 * 1e-3) } else { 0.0 };
                    let pushed = single.flow_ml_rad() * speed_rad_s;
                    let sign = if port == Port::Outlet { 1.0 } else { -1.0 };
                    let expected = sign * (pushed - state.state.flow_ml_s) / line.compliance_ml_kpa;
                    let missed = (rate[n] - expected).abs() * line.compliance_ml_kpa;
                    assert!(missed < 1e-7 || missed_ml_rad > 0.01, "{n}: {} {expected}", rate[n]);
                    for (k, column) in columns.iter().enumerate() {
                        let value = |state: &SensitiveState| match k {
                            0 => state.state.above_reservoir_kpa,
                            _ => state.pressure_by[k - 1],
                        };
                        scale[k] = scale[k].max(value(&state).abs());
                        // At an edge the derivative by the angle jumps, and rounding decides on which side a sample
                        // lies.
                        for found in [column[n], value(&next)] {
                            let missed = (found - value(&state)).abs();
                            let jumps = k == 4 && missed > 1.0;
                            worst[k] = worst[k].max(if jumps { 0.0 } else { missed });
                        }
                    }
                }
                let sizes = [1.0, 1.0, line.compliance_ml_kpa, line.inertance_kpa_s2_ml, 1.0, 1.0];
                for k in 0..6 {
                    let large = scale[k].max(scale[0] / sizes[k]);
                    assert!(worst[k] <= 1e-12 * large, "{k}: {} {large}, {line:?}", worst[k]);
                }
            }
        }
    }
}

#[test]
fn the_derivative_by_the_angle_jumps_where_the_flow_does() {
    let pump = Pump::three_roller();
    let speed = 10.0;
    let edge_rad = pump.pitch_rad();
    let mut run =
        SensitiveRun::new(&pump, Port::Outlet, [Leg::constant_speed(0.5, speed)], SensitiveState::AT_REST);
    let edge_s = (edge_rad - 0.5) / speed;
    let [before, after] = [edge_s - 1e-9, edge_s + 1e-9].map(|t| run.at(t));
    let curve = pump.outlet_curve();
    let jump = curve.flow_ml_rad(edge_rad + 1e-9) - curve.flow_ml_rad(edge_rad - 1e-9);
    let seen = after.pressure_by[3] - before.pressure_by[3];
    assert!(jump.abs() > 0.1, "{jump}");
    assert!((seen - jump / Line::PUBLISHED.compliance_ml_kpa).abs() < 1e-5, "{seen} {jump}");
    // Across the edge the state itself is differentiable: both sides of the difference see the edge.
    let case = Case {
        rollers: 3,
        line: Line::PUBLISHED,
        roller_ml: 2.0,
        port: Port::Outlet,
        legs: vec![Leg::constant_speed(0.5, speed)],
        start: Start::Given(LineState::AT_REST),
    };
    case.check(&[edge_s - 0.003, edge_s + 0.003], 1e-8);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn derivatives_of_random_pumps_are_the_limits_of_differences(
        rollers in 2_u32..9,
        damping in -2.0_f64..1.0,
        compliance in -2.5_f64..-0.5,
        inertance in -3.5_f64..-1.5,
        roller_ml in 0.5_f64..2.3,
        speed in 2.0_f64..20.0,
        reverse in any::<bool>(),
        outlet in any::<bool>(),
        steady in any::<bool>(),
        start in 0.03_f64..0.97,
    ) {
        let (compliance, inertance) = (10_f64.powf(compliance), 10_f64.powf(inertance));
        let resistance = 2.0 * 10_f64.powf(damping) * (inertance / compliance).sqrt();
        let line = line(resistance, compliance, inertance);
        let speed = if reverse { -speed } else { speed };
        let port = if outlet { Port::Outlet } else { Port::Inlet };
        let whole = pump(rollers, line, roller_ml);
        let near_edge = |rad: f64| {
            // A difference across an edge at an end of the run has no limit.
            let q = |off: f64| whole.curve(port).flow_ml_rad(rad + off);
            (q(0.003) - q(-0.003)).abs() > 0.3
        };
        let start_rad = start * whole.pitch_rad();
        let times_s: Vec<f64> = [0.013, 0.11, 0.47].into_iter()
            .filter(|t| !near_edge(start_rad + speed * t)).collect();
        prop_assume!(!near_edge(start_rad));
        let start = if steady { Start::Steady } else { Start::Given(LineState::AT_REST) };
        let legs = vec![Leg::constant_speed(start_rad, speed)];
        Case { rollers, line, roller_ml, port, legs, start }.check(&times_s, 1e-7);
    }
}
