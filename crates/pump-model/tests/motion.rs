//! Claims about motions with ramps, reversals and stops: volume balance, settling, steady states that do not
//! exist.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use core::f64::consts::TAU;

use proptest::prelude::*;
use pump_model::{
    DEFAULT_TOLERANCE, ExactRun, Leg, Line, LineState, ModelError, Port, PortRun, Pump, SETTLED_ML, Variant,
};

/// Returns legs that follow each other from `angle_rad` at rest, with these (duration in s, acceleration in
/// rad/s²).
fn legs(angle_rad: f64, parts: &[(f64, f64)]) -> Vec<Leg> {
    let mut next =
        Leg { start_s: 0.0, duration_s: 0.0, angle_rad, speed_rad_s: 0.0, acceleration_rad_s2: 0.0 };
    parts
        .iter()
        .map(|&(duration_s, acceleration_rad_s2)| {
            let leg = Leg { duration_s, acceleration_rad_s2, ..next };
            next = Leg {
                start_s: leg.end_s(),
                angle_rad: leg.end_angle_rad(),
                speed_rad_s: leg.speed_at(leg.end_s()),
                ..next
            };
            leg
        })
        .collect()
}

fn with_outlet(outlet: Line) -> Pump {
    let three = Pump::three_roller();
    Pump::new(*three.geometry(), *three.roller_volume(), *three.inlet(), outlet).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    /// The integral of the line's flow is V(theta_1) - V(theta_0) - C (P_1 - P_0) at the outlet. At the inlet
    /// the line feeds the rollers, so the compliance counts the other way.
    #[test]
    fn volume_is_balanced_over_any_motion(
        rollers in 2u32..=11,
        start in -10.0..10.0_f64,
        parts in prop::collection::vec((0.0..0.6_f64, -60.0..60.0_f64), 1..8),
        pressure in -5.0..5.0_f64,
        flow in -10.0..10.0_f64,
    ) {
        let pump = Pump::preset(rollers, Variant::Measured).unwrap();
        let motion = legs(start, &parts);
        let (end_s, end_rad) = motion.last().map(|leg| (leg.end_s(), leg.end_angle_rad())).unwrap();
        for (port, sign) in [(Port::Inlet, -1.0), (Port::Outlet, 1.0)] {
            let state = LineState { above_reservoir_kpa: pressure, flow_ml_s: flow };
            let mut run = PortRun::<_, 3>::new(&pump, port, motion.iter().copied(), state, 1e-9).unwrap();
            let end = run.run_to(end_s + 0.1).unwrap();
            let rollers_ml = pump.curve(port).volume_ml(end_rad) - pump.curve(port).volume_ml(start);
            let stored_ml = sign * pump.line(port).compliance_ml_kpa * (end.above_reservoir_kpa - pressure);
            let passed_ml = run.passed_ml();
            prop_assert!((passed_ml - (rollers_ml - stored_ml)).abs() < 1e-7, "{:?}: {}", port, passed_ml);
        }
    }

    /// Samples between steps come from dense output; they must agree with steps that end there.
    #[test]
    fn samples_agree_with_steps_that_end_on_them(start in 0.0..TAU, speed in -30.0..30.0_f64, t in 0.01..1.0_f64) {
        let pump = Pump::three_roller();
        let motion = [Leg::constant_speed(start, speed)];
        let run = || PortRun::<_, 2>::from_rest(&pump, Port::Outlet, motion, 1e-9).unwrap();
        let (sampled, stepped) = (run().at(t).unwrap(), run().run_to(t).unwrap());
        let off = (sampled.above_reservoir_kpa - stepped.above_reservoir_kpa).abs();
        let off = off.max((sampled.flow_ml_s - stepped.flow_ml_s).abs());
        prop_assert!(off < 1e-6, "{:?} for {:?}", sampled, stepped);
    }
}

#[test]
fn running_back_returns_every_drop() {
    let pump = Pump::three_roller();
    // The motion goes up to 12 rad/s and down, and then likewise in reverse.
    let motion = legs(0.2, &[(0.2, 60.0), (0.4, -60.0), (0.2, 60.0)]);
    let end = motion.last().unwrap();
    assert!((end.end_angle_rad() - 0.2).abs() < 1e-12);
    let mut run = PortRun::<_, 3>::from_rest(&pump, Port::Outlet, motion.iter().copied(), 1e-9).unwrap();
    run.run_to(end.end_s() + 1.5).unwrap();
    assert!(run.passed_ml().abs() < 1e-7);
}

#[test]
fn after_the_settling_time_less_than_a_microlitre_moves_and_before_it_more() {
    for line in [
        Line::PUBLISHED,
        Line { resistance_kpa_s_ml: 2.0, ..Line::PUBLISHED },
        Line { compliance_ml_kpa: 1.0, resistance_kpa_s_ml: 0.5, ..Line::PUBLISHED },
        Line { compliance_ml_kpa: 5.0, resistance_kpa_s_ml: 20.0, ..Line::PUBLISHED },
    ] {
        let pump = with_outlet(line);
        let motion = legs(0.0, &[(0.02, 500.0), (0.5, 0.0), (0.02, -500.0)]);
        let end_s = motion.last().unwrap().end_s();
        let run = || ExactRun::from_rest(&pump, Port::Outlet, motion.iter().copied());
        let mut moving = run();
        moving.at(end_s);
        let settle_s = moving.settling_s().unwrap();
        let undelivered_ml =
            |run: &mut ExactRun<'_, _>, t| (line.compliance_ml_kpa * run.at(t).above_reservoir_kpa).abs();
        let mut sampled = run();
        assert!(undelivered_ml(&mut sampled, end_s + settle_s * (1.0 - 1e-5)) > SETTLED_ML);
        for n in 0..2000 {
            let t = end_s + settle_s * (1.0 + 1e-5) + f64::from(n) * 1e-3;
            assert!(undelivered_ml(&mut sampled, t) < SETTLED_ML, "{line:?} at {t}");
        }
    }
}

#[test]
fn a_line_without_resistance_never_settles_and_may_resonate_for_ever() {
    let line = Line { resistance_kpa_s_ml: 0.0, ..Line::PUBLISHED };
    let pump = with_outlet(line);
    let motion = legs(0.0, &[(0.02, 500.0), (0.02, -500.0)]);
    let mut run = ExactRun::from_rest(&pump, Port::Outlet, motion);
    run.at(0.04);
    assert!(matches!(run.settling_s(), Err(ModelError::NeverSettles { .. })));

    let resonant_rad_s = line.natural_rad_s() / 3.0;
    let error = pump.steady_state(resonant_rad_s).unwrap_err();
    assert!(matches!(error, ModelError::UndampedResonance { port: Port::Outlet, .. }), "{error}");
    assert!(pump.steady_state(0.9 * resonant_rad_s).is_ok(), "off resonance there is a periodic state");
    assert!(matches!(pump.steady_state(0.0), Err(ModelError::OutOfRange { .. })));
}

#[test]
fn near_standstill_a_steady_state_is_that_of_the_resistance_alone() {
    let stiff = Line { resistance_kpa_s_ml: 300.0, ..Line::PUBLISHED };
    for line in [Line::PUBLISHED, stiff] {
        let pump = with_outlet(line);
        let most_ml_rad = pump.geometry().nominal_ml_rad();
        for rpm in [1e-12, 1e-9, 1e-6, 1e-4] {
            let speed_rad_s = rpm * TAU / 60.0;
            let steady = pump.steady_state(speed_rad_s).unwrap();
            let quasi_kpa = line.resistance_kpa_s_ml * most_ml_rad * speed_rad_s;
            let above_kpa = steady.outlet.max_kpa - line.reservoir_kpa;
            // The flow jumps by 2.6 % where the roller volume begins, and a line that swings overshoots.
            let most_kpa = 1.02 * quasi_kpa + 2e-14;
            let range_kpa = 0.9999 * quasi_kpa - 2e-14..most_kpa;
            assert!(range_kpa.contains(&above_kpa), "{rpm}: {above_kpa} for {quasi_kpa}");
            let LineState { flow_ml_s, .. } = pump.periodic_state(Port::Outlet, speed_rad_s).unwrap();
            let before_ml_s = speed_rad_s * pump.curve(Port::Outlet).flow_ml_rad(pump.pitch_rad() - 1e-9);
            assert!((flow_ml_s / before_ml_s - 1.0).abs() < 1e-4, "{rpm}: {flow_ml_s} for {before_ml_s}");
        }
    }
}

#[test]
fn a_line_that_rings_all_through_a_pitch_of_days_is_refused_and_not_computed_for_minutes() {
    let line = Line { resistance_kpa_s_ml: 1e-6, ..Line::PUBLISHED };
    let pump = with_outlet(line);
    let error = pump.steady_state(1e-4).unwrap_err();
    assert!(matches!(error, ModelError::RingsTooLong { port: Port::Outlet, .. }), "{error}");
    assert!(error.to_string().contains("more resistance"), "{error}");
    assert!(pump.steady_state(1.0).is_ok());
    let some = with_outlet(Line { resistance_kpa_s_ml: 1e-2, ..line });
    assert!(some.steady_state(1e-9).is_ok(), "what dies out costs nothing");
    // An overdamped line has no resonance, however stiff and however fast the pump.
    let stiff = with_outlet(Line { resistance_kpa_s_ml: 1e6, ..line });
    let mean_kpa = stiff.steady_state(1.0).unwrap().outlet_mean_kpa;
    assert!(mean_kpa > 1e6, "{mean_kpa}");
}

#[test]
fn a_motion_without_legs_stays_at_rest() {
    let pump = Pump::three_roller();
    let mut run = PortRun::<_, 2>::from_rest(&pump, Port::Outlet, [], DEFAULT_TOLERANCE).unwrap();
    assert_eq!(run.at(5.0).unwrap(), LineState::AT_REST);
    assert!(PortRun::<_, 2>::from_rest(&pump, Port::Outlet, [], 0.0).is_err(), "no tolerance");
}
