//! The exact solution against the integrator, over random pumps, lines, motions and initial states.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use core::f64::consts::TAU;

use proptest::prelude::*;
use pump_model::{DEFAULT_TOLERANCE, ExactRun, Leg, Line, LineState, Port, PortRun, Pump, Variant};

/// Lines from soft to stiff, under-, over- and critically damped, with a head.
fn any_line() -> impl Strategy<Value = Line> {
    (-3.0..0.5_f64, -3.0..-1.0_f64, -3.5..-2.0_f64, prop::option::weighted(0.1, Just(1.0)), 60.0..120.0_f64)
        .prop_map(|(r, c, l, critical, reservoir_kpa)| {
            let [resistance, compliance_ml_kpa, inertance_kpa_s2_ml] = [r, c, l].map(|x| 10_f64.powf(x));
            let damped = 2.0 * (inertance_kpa_s2_ml / compliance_ml_kpa).sqrt();
            let resistance_kpa_s_ml = critical.map_or(resistance, |ratio: f64| ratio * damped);
            Line { resistance_kpa_s_ml, compliance_ml_kpa, inertance_kpa_s2_ml, reservoir_kpa }
        })
}

fn any_pump() -> impl Strategy<Value = Pump> {
    (2u32..=12, any_line(), any_line()).prop_map(|(rollers, inlet, outlet)| {
        let preset = Pump::preset(rollers, Variant::Measured).unwrap();
        Pump::new(*preset.geometry(), *preset.roller_volume(), inlet, outlet).unwrap()
    })
}

/// Steps, ramps, reversals and a stop.
fn any_motion() -> impl Strategy<Value = Vec<Leg>> {
    let part = (0.01..0.5_f64, -20.0..20.0_f64, prop_oneof![Just(0.0), -200.0..200.0_f64]);
    (0.0..TAU, prop::collection::vec(part, 1..5)).prop_map(|(angle, parts)| {
        let (mut start_s, mut angle_rad) = (0.0, angle);
        parts
            .into_iter()
            .map(|(duration_s, speed_rad_s, acceleration_rad_s2)| {
                let leg = Leg { start_s, duration_s, angle_rad, speed_rad_s, acceleration_rad_s2 };
                (start_s, angle_rad) = (leg.end_s(), leg.end_angle_rad());
                leg
            })
            .collect()
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 150, ..ProptestConfig::default() })]

    #[test]
    fn all_agree_to_1e_9_of_the_swing(
        pump in any_pump(),
        motion in any_motion(),
        pressure in -20.0..20.0_f64,
        flow in -50.0..50.0_f64,
    ) {
        let end_s = motion.last().unwrap().end_s() + 0.3;
        for port in [Port::Inlet, Port::Outlet] {
            let legs = || motion.iter().copied();
            let state = LineState { above_reservoir_kpa: pressure, flow_ml_s: flow };
            let mut exact = ExactRun::new(&pump, port, legs(), state);
            let mut integrated = PortRun::<_, 2>::new(&pump, port, legs(), state, 1e-12).unwrap();
            let mut by_radau = integrated.clone().with_radau().unwrap();
            let mut swing = 1.0_f64;
            let mut worst = 0.0_f64;
            for n in 0..=500 {
                let t = end_s * f64::from(n) / 500.0;
                let exact_kpa = exact.at(t).above_reservoir_kpa;
                swing = swing.max(exact_kpa.abs());
                for run in [&mut integrated, &mut by_radau] {
                    worst = worst.max((exact_kpa - run.at(t).unwrap().above_reservoir_kpa).abs());
                }
            }
            prop_assert!(worst < 1e-9 * swing, "{:?}: {:e} of {}", port, worst, swing);
        }
    }

    #[test]
    fn equal_intervals_give_what_single_times_give(
        pump in any_pump(),
        motion in any_motion(),
        dt_s in 1e-4..5e-2_f64,
    ) {
        let run = || ExactRun::from_rest(&pump, Port::Outlet, motion.iter().copied());
        let mut single = run();
        let mut swing = 1.0_f64;
        for (n, sample) in run().every(dt_s).take(200).enumerate() {
            let expected = single.at(n as f64 * dt_s);
            swing = swing.max(expected.above_reservoir_kpa.abs());
            let off_kpa = sample.above_reservoir_kpa - expected.above_reservoir_kpa;
            prop_assert!(off_kpa.abs() < 1e-10 * swing, "{}: {:?}, {:?}", n, sample, expected);
        }
    }

    /// The times rise by steps from far below to far above the swing, and some are equal.
    #[test]
    fn a_series_gives_what_single_times_give(
        pump in any_pump(),
        motion in any_motion(),
        steps_s in proptest::collection::vec(prop_oneof![Just(0.0), 1e-6..1e-3_f64, 1e-3..0.1_f64], 200),
    ) {
        for port in [Port::Inlet, Port::Outlet] {
            let run = || ExactRun::from_rest(&pump, port, motion.iter().copied());
            let times_s: Vec<f64> = steps_s.iter().scan(0.0, |t, step| { *t += step; Some(*t) }).collect();
            let (mut single, mut series) = (run(), run().in_series());
            let mut kpa = vec![0.0; times_s.len()];
            let (now, later) = kpa.split_at_mut(77);
            series.fill_kpa(&times_s[..77], now);
            series.fill_kpa(&times_s[77..], later);
            let mut swing = 1.0_f64;
            for (t, kpa) in times_s.iter().zip(&kpa) {
                let expected = single.at(*t).above_reservoir_kpa;
                swing = swing.max(expected.abs());
                prop_assert!((kpa - expected).abs() < 1e-10 * swing, "{}: {}, {}", t, kpa, expected);
            }
            let [state, expected] = [series.state(), single.state()];
            prop_assert!((state.above_reservoir_kpa - expected.above_reservoir_kpa).abs() < 1e-10 * swing);
            prop_assert!((state.flow_ml_s - expected.flow_ml_s).abs() < 1e-9 * (swing + expected.flow_ml_s.abs()));
        }
    }

    /// Fine samples lie inside the extremes and come close to them.
    #[test]
    fn extremes_are_those_of_fine_samples(pump in any_pump(), motion in any_motion()) {
        let end_s = motion.last().unwrap().end_s() + 0.3;
        for port in [Port::Inlet, Port::Outlet] {
            let run = || ExactRun::from_rest(&pump, port, motion.iter().copied());
            let base = pump.line(port).reservoir_kpa;
            let found = run().extremes(end_s);
            let samples = run().every(end_s / 20_000.0).take(20_001);
            let (low, high) = samples.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), sample| {
                (low.min(sample.above_reservoir_kpa + base), high.max(sample.above_reservoir_kpa + base))
            });
            let swing = (high - low).max(1e-3);
            prop_assert!(found.min_kpa <= low + 1e-9 * swing && found.max_kpa >= high - 1e-9 * swing);
            // The stiffest line swings 2000 rad/s; a sample misses a turn by (0.1 ms 2000 /s)²/8.
            prop_assert!(low - found.min_kpa < 1e-2 * swing && found.max_kpa - high < 1e-2 * swing);
        }
    }

    #[test]
    fn the_periodic_state_repeats_itself(pump in any_pump(), speed in prop_oneof![-30.0..-0.1_f64, 0.1..30.0_f64]) {
        for port in [Port::Inlet, Port::Outlet] {
            let state = pump.periodic_state(port, speed).unwrap();
            let motion = [Leg::constant_speed(0.0, speed)];
            let again = ExactRun::new(&pump, port, motion, state).at(pump.pitch_rad() / speed.abs());
            let [state, again] = [state, again].map(|state| [state.above_reservoir_kpa, state.flow_ml_s]);
            let scale = 1.0 + state[0].abs() + state[1].abs();
            prop_assert!((again[0] - state[0]).abs() < 1e-9 * scale && (again[1] - state[1]).abs() < 1e-9 * scale);
        }
    }
}

/// Slow motion and stiff lines, where a step of the integrator is many times the line's time constant.
#[test]
fn slow_motion_and_stiff_lines_stay_within_what_the_flow_can_do() {
    let stiff = Line { compliance_ml_kpa: 1e-6, inertance_kpa_s2_ml: 1e-6, ..Line::PUBLISHED };
    let three = Pump::three_roller();
    let stiff_pump = Pump::new(*three.geometry(), *three.roller_volume(), stiff, stiff).unwrap();
    for (pump, speed) in [(three, 1e-3), (three, 1e-2), (three, 0.1), (stiff_pump, 1e-3), (stiff_pump, 1.0)] {
        let period_s = pump.pitch_rad() / speed;
        // P - P_res follows R q once settled, within the swing that the 2.6 % jump of the flow leaves.
        let highest = 0.1108 * 4.4 * speed;
        let motion = [Leg::constant_speed(1.0, speed)];
        let mut exact = ExactRun::from_rest(&pump, Port::Outlet, motion);
        let mut integrated =
            PortRun::<_, 2>::from_rest(&pump, Port::Outlet, motion, DEFAULT_TOLERANCE).unwrap();
        let mut by_radau = integrated.clone().with_radau().unwrap();
        for n in 1..1000 {
            let t = period_s * f64::from(n) / 1000.0;
            let exact = exact.at(t).above_reservoir_kpa;
            let integrated = integrated.at(t).unwrap().above_reservoir_kpa;
            // The tolerance does not control the output of order four inside a stiff step.
            let bound = if pump == three { 5e-4 } else { 3e-3 };
            assert!((exact - integrated).abs() < bound, "{speed} rad/s at {t} s: {exact} or {integrated}");
            let by_radau = by_radau.at(t).unwrap().above_reservoir_kpa;
            assert!((exact - by_radau).abs() < 1e-4, "{speed} rad/s at {t} s: {exact} or {by_radau}");
        }
        let steady = pump.steady_state(speed).unwrap();
        assert!(steady.outlet.max_kpa - 88.637 < 1.3 * highest, "{speed}: {steady:?}");
        assert!(steady.outlet.min_kpa - 88.637 > -0.3 * highest, "{speed}: {steady:?}");
    }
}
