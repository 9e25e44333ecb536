//! Claims about doses whose speed follows the rollers' angle for a smooth flow.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use proptest::prelude::*;
use pump_ctl::plan::{Cruise, Doser, Limits, Motor, Phase, Plan, PlanError, Request, Retarget};
use pump_model::{ExactRun, Geometry, Leg, Line, LineState, Port, Pump, RollerVolume, Variant};

const TAU: f64 = core::f64::consts::TAU;

fn rad_s(rpm: f64) -> f64 {
    rpm * TAU / 60.0
}

fn pump(rollers: u32) -> Pump {
    Pump::new(
        Geometry::published(rollers, Variant::Measured),
        RollerVolume::measured().unwrap(),
        Line::PUBLISHED,
        Line::PUBLISHED,
    )
    .unwrap()
}

/// The motor of the built-in pumps.
fn limits(rollers: u32) -> Limits {
    let max_rpm = if rollers == 2 { 300.0 } else { 170.0 };
    Limits::new(Motor::new(12_800.0, rad_s(max_rpm), 500.0))
}

fn smooth(pump: &Pump, volume_ml: f64, start_rad: f64, cruise: Cruise) -> Plan {
    let limits = limits(pump.geometry().rollers);
    Doser::new(pump, limits)
        .unwrap()
        .plan(Phase::known(start_rad), &Request::new(volume_ml, cruise).with_smooth(true))
        .unwrap()
}

/// Returns the pump with another outlet line.
fn with_outlet(pump: &Pump, line: Line) -> Pump {
    Pump::new(*pump.geometry(), *pump.roller_volume(), *pump.inlet(), line).unwrap()
}

#[test]
fn ripple_is_what_the_acceleration_allows() {
    // Each row is r/min, then (peak-to-peak %, RMS %) for three rollers and for two. The figures were
    // computed independently, with a fine envelope.
    let table = [
        (20.0, (24.0, 2.3), (28.6, 2.3)),
        (50.0, (63.0, 10.7), (64.7, 9.2)),
        (100.0, (84.0, 20.8), (83.3, 17.3)),
    ];
    for (rpm, three, two) in table {
        for (rollers, (peak_to_peak, rms), (peak_before, rms_before)) in
            [(3, three, (118.0, 42.7)), (2, two, (107.1, 34.2))]
        {
            // The figures are those of the flow at the rollers, which a line that follows the flow leaves alone.
            let stiff = Line { compliance_ml_kpa: 1e-6, ..Line::PUBLISHED };
            let pump = with_outlet(&pump(rollers), stiff);
            // The figures hold for a motor whose largest speed does not bind.
            let request = Request::new(100.0, Cruise::Speed { rad_s: rad_s(rpm) }).with_smooth(true);
            let plan = Doser::new(&pump, limits(2)).unwrap().plan(Phase::known(0.3), &request).unwrap();
            let ripples = plan.ripples(&pump);
            let near = |found: f64, expected: f64, part| (100.0 * found / expected - 1.0).abs() < part;
            assert!(near(ripples.before.peak_to_peak, peak_before, 0.005), "{ripples:?}");
            assert!(near(ripples.before.rms, rms_before, 0.005), "{ripples:?}");
            assert!(near(ripples.after.peak_to_peak, peak_to_peak, 0.1), "{rollers} {rpm} {ripples:?}");
            assert!(near(ripples.after.rms, rms, 0.1), "{rollers} {rpm} {ripples:?}");
        }
    }
}

#[test]
fn the_flow_is_even_up_to_the_rate_that_the_acceleration_allows_but_for_the_jump() {
    for (rollers, flow_ml_s) in [(3, 1.0), (3, 4.2), (2, 1.0), (2, 4.2)] {
        let pump = pump(rollers);
        let plan = smooth(&pump, 30.0, 0.3, Cruise::Flow { ml_s: flow_ml_s });
        let ripple = plan.ripples(&pump).after;
        assert!(ripple.peak_to_peak < 0.035 && ripple.rms < 0.0025, "{ripple:?} at {flow_ml_s} mL/s");
        assert!((plan.cruise_flow_ml_s(&pump) / flow_ml_s - 1.0).abs() < 1e-9);
    }
    let pump = pump(3);
    let faster = smooth(&pump, 30.0, 0.3, Cruise::Flow { ml_s: 6.0 });
    assert!(faster.ripples(&pump).after.peak_to_peak > 0.1);
}

#[test]
fn any_number_of_rollers_has_less_ripple_than_at_constant_speed() {
    // Pulses overlap from 8 rollers on.
    for rollers in 2..=11 {
        let pump = pump(rollers);
        for part in [0.02, 0.3, 0.9] {
            let speed = part * limits(rollers).motor.max_speed_rad_s;
            let plan = smooth(&pump, 60.0, 0.3, Cruise::Speed { rad_s: speed });
            let ripples = plan.ripples(&pump);
            assert!(ripples.after.rms < ripples.before.rms, "{rollers} {part}: {ripples:?}");
            assert!((plan.profile().cruise_rad_s() / speed - 1.0).abs() < 1e-9);
            if part == 0.02 {
                // Overlapping pulses make the flow jump where it is smallest, by up to 22 % of the mean.
                assert!(ripples.after.rms < 0.015, "{rollers}: {ripples:?}");
            }
        }
    }
}

#[test]
fn at_the_motors_fastest_the_speed_is_constant_and_beyond_it_nothing_can_be_had() {
    let pump = pump(3);
    let limit_ml_s = pump.average_flow_ml_s(limits(3).motor.max_speed_rad_s);
    let fastest = smooth(&pump, 60.0, 0.3, Cruise::Flow { ml_s: limit_ml_s * (1.0 - 1e-12) });
    let ripples = fastest.ripples(&pump);
    assert!((ripples.after.rms / ripples.before.rms - 1.0).abs() < 1e-6, "{ripples:?}");
    let request = Request::new(60.0, Cruise::Flow { ml_s: 1.001 * limit_ml_s }).with_smooth(true);
    let refused = Doser::new(&pump, limits(3)).and_then(|doser| doser.plan(Phase::known(0.3), &request));
    assert!(matches!(refused, Err(PlanError::RateTooHigh { .. })), "{refused:?}");
}

#[test]
fn a_smooth_flow_from_an_angle_that_nobody_knows_is_refused() {
    let pump = pump(3);
    let with = |half_width_rad| {
        let request = Request::new(25.0, Cruise::Flow { ml_s: 5.0 }).with_smooth(true);
        Doser::new(&pump, limits(3))
            .and_then(|doser| doser.plan(Phase::within(0.3, half_width_rad), &request))
    };
    let refused = with(0.5 * pump.pitch_rad()).unwrap_err();
    assert!(matches!(refused, PlanError::SmoothWithoutAngle { .. }), "{refused}");
    assert!(matches!(with(0.2), Err(PlanError::SmoothWithoutAngle { .. })));
    // Half a turn to either side is every angle there is.
    assert!(with(0.2).unwrap_err().to_string().contains("which is known within 11.5 degrees: at this"));
    let nobody = with(3.2).unwrap_err().to_string();
    assert!(nobody.contains("the rollers' angle, which is unknown: at this rate a speed that"), "{nobody}");
    // An angle known to two full motor steps still makes the flow smoother, and the worst ripple is reported.
    let uncertain = with(0.01).unwrap().ripples(&pump);
    let certain = with(0.0).unwrap().ripples(&pump);
    assert!(uncertain.after.rms > 1.5 * certain.after.rms, "{uncertain:?} {certain:?}");
    assert!(uncertain.after.rms < uncertain.before.rms, "{uncertain:?}");
}

/// A dose as (rollers, volume in mL, start angle in rad, part of the fastest speed, smooth).
fn any_dose() -> impl Strategy<Value = (u32, f64, f64, f64, bool)> {
    let part = prop_oneof![0.002..0.1_f64, 0.1..1.0_f64];
    (2u32..=11, 0.05..60.0_f64, any::<bool>(), -7.0..7.0_f64, part, any::<bool>()).prop_map(
        |(rollers, volume, reverse, start, part, smooth)| {
            (rollers, if reverse { -volume } else { volume }, start, part, smooth)
        },
    )
}

/// Checks the motion itself. It is continuous, within speed and acceleration, and as fast as the acceleration
/// allows. Its times follow it.
fn check_motion(plan: &Plan, limits: &Limits, start_rad_s: f64) -> Result<(), TestCaseError> {
    let sign = f64::from(plan.direction().sign());
    let (mut at_s, mut angle, mut speed) = (0.0, plan.start().angle_rad(), sign * start_rad_s);
    let most = limits.motor.max_speed_rad_s.max(start_rad_s) * (1.0 + 1e-9);
    for leg in plan.legs() {
        let middle_s = leg.start_s + 0.5 * leg.duration_s;
        prop_assert!((leg.start_s - at_s).abs() < 1e-9 * (1.0 + at_s), "{leg:?} at {at_s}");
        prop_assert!((leg.angle_rad - angle).abs() < 1e-9, "{leg:?} at {angle}");
        prop_assert!((leg.speed_rad_s - speed).abs() < 1e-6, "{leg:?} at {speed}");
        prop_assert!(leg.acceleration_rad_s2.abs() <= limits.motor.max_acceleration_rad_s2 * (1.0 + 1e-9));
        (at_s, angle, speed) = (leg.end_s(), leg.end_angle_rad(), leg.speed_at(leg.end_s()));
        prop_assert!(leg.speed_rad_s * sign >= 0.0 && leg.speed_rad_s * sign <= most);
        let turned = sign * (leg.angle_at(middle_s) - plan.start().angle_rad());
        prop_assert!((plan.profile().time_of(turned) - middle_s).abs() < 1e-9 * (1.0 + at_s), "{leg:?}");
        prop_assert!((plan.angle_at(middle_s) - leg.angle_at(middle_s)).abs() < 1e-9, "{leg:?}");
        prop_assert!((plan.speed_at(middle_s) - leg.speed_at(middle_s)).abs() < 1e-6, "{leg:?}");
    }
    prop_assert!((at_s - plan.profile().duration_s()).abs() < 1e-9 * (1.0 + at_s));
    prop_assert!((angle - plan.end_angle_rad()).abs() < 1e-9);
    prop_assert!(speed.abs() < 1e-3, "ends at {speed}");
    prop_assert!(plan.profile().peak_rad_s() <= most);
    let fastest = plan.legs().map(|leg| leg.speed_rad_s.abs()).fold(0.0, f64::max);
    prop_assert!((plan.profile().peak_rad_s() - fastest).abs() < 1e-9, "{fastest}");
    Ok(())
}

/// Checks the steps of a smooth dose. They are as many as at constant speed, rise in time, and come in
/// segments that are right to a tick.
fn check_steps(plan: &Plan) -> Result<(), TestCaseError> {
    const TICK_RATE: pump_ctl::step::TickRate = pump_ctl::step::TickRate::from_hz(1_000_000).unwrap();
    let mut segments = plan.segments(TICK_RATE);
    let (mut left, mut due, mut interval, mut add) = (0, 0_i128, 0_i128, 0);
    let mut last_s = 0.0;
    for step in plan.each_step() {
        if left == 0 {
            let segment = segments.next().unwrap();
            prop_assert_eq!(segment.direction(), plan.direction());
            left = segment.steps();
            interval = (i128::from(segment.interval) << 32) + i128::from(segment.frac);
            add = i128::from(segment.add);
        }
        due += interval;
        interval += add;
        left -= 1;
        let ticks = due as f64 / 4_294_967_296.0;
        let time = step.time_s * f64::from(TICK_RATE.hz());
        prop_assert!((ticks - time).abs() < 1.0, "step {} at {time}, made at {ticks}", step.number);
        prop_assert!(step.time_s > last_s || step.number == 1);
        last_s = step.time_s;
    }
    prop_assert!(segments.next().is_none() && left == 0);
    prop_assert_eq!(last_s.to_bits(), plan.profile().duration_s().to_bits());
    Ok(())
}

/// Runs `whole` up to the moment at which `made` steps are made, then `rest`.
fn joined(whole: &Plan, made: u64, rest: &Plan) -> Vec<Leg> {
    let changed_s = whole.profile().time_of(made as f64 * whole.step_rad());
    let before = whole.legs().filter(|leg| leg.start_s < changed_s);
    let before = before.map(|leg| Leg { duration_s: leg.duration_s.min(changed_s - leg.start_s), ..leg });
    let after = rest.legs().map(|leg| Leg { start_s: leg.start_s + changed_s, ..leg });
    before.chain(after).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    #[test]
    fn a_smooth_dose_makes_the_same_steps_within_the_motors_limits(
        (rollers, volume, start, part, _) in any_dose(),
        acceleration in prop_oneof![Just(500.0), 0.5..20.0_f64, 1e3..1e5_f64],
    ) {
        let pump = pump(rollers);
        let mut limits = limits(rollers);
        limits.motor.max_acceleration_rad_s2 = acceleration;
        let request = Request::new(volume, Cruise::Speed { rad_s: part * limits.motor.max_speed_rad_s });
        let even = Doser::new(&pump, limits).unwrap().plan(Phase::known(start), &request).unwrap();
        let smooth = Doser::new(&pump, limits).unwrap().plan(Phase::known(start), &request.with_smooth(true)).unwrap();
        prop_assert_eq!(even.steps(), smooth.steps());
        prop_assert_eq!(even.end_angle_rad().to_bits(), smooth.end_angle_rad().to_bits());
        prop_assert_eq!(even.carry_ml().to_bits(), smooth.carry_ml().to_bits());
        check_motion(&smooth, &limits, 0.0)?;
        check_steps(&smooth)?;
    }

    #[test]
    fn a_rate_changes_and_a_rotor_stops_at_any_instant_from_and_to_a_smooth_flow(
        (rollers, volume, start, part, smooth) in any_dose(),
        (new_part, to_smooth) in (0.002..1.0_f64, any::<bool>()),
        moment in 0.0..1.0_f64,
        more in -1.0..30.0_f64,
    ) {
        let (pump, limits) = (pump(rollers), limits(rollers));
        let volume = volume + volume.signum();
        let top = limits.motor.max_speed_rad_s;
        let request = Request::new(volume, Cruise::Speed { rad_s: part * top }).with_smooth(smooth);
        let doser = Doser::new(&pump, limits).unwrap();
        let whole = doser.plan(Phase::known(start), &request).unwrap();
        let made = (moment * whole.steps().unsigned_abs() as f64) as u64;
        let cruise = Cruise::Speed { rad_s: new_part * top };
        let new_volume = volume + volume.signum() * more;
        match doser.retarget(&whole, &Retarget::new(made, new_volume, cruise).with_smooth(to_smooth)) {
            Ok(rest) => {
                check_motion(&rest, &limits, whole.speed_after(made))?;
                check_steps(&rest)?;
                let balance_ml = whole.delivered_ml(&pump, made) + rest.planned_ml() + rest.carry_ml() - new_volume;
                prop_assert!(balance_ml.abs() < 1e-9);
                let changed_s = whole.profile().time_of(made as f64 * whole.step_rad());
                let mut run = ExactRun::from_rest(&pump, Port::Outlet, joined(&whole, made, &rest));
                run.at(changed_s);
                let expected = run.extremes(changed_s + rest.profile().duration_s() + 0.5);
                let predicted = rest.predict(&pump).unwrap().outlet;
                prop_assert!((predicted.min_kpa - expected.min_kpa).abs() < 1e-6, "{predicted:?} {expected:?}");
                prop_assert!((predicted.max_kpa - expected.max_kpa).abs() < 1e-6, "{predicted:?} {expected:?}");
            }
            Err(PlanError::CannotStopThere { .. }) => {}
            Err(other) => return Err(TestCaseError::fail(other.to_string())),
        }
        if let Some(stop) = whole.stop(&pump, made) {
            check_motion(&stop, &limits, whole.speed_after(made))?;
            prop_assert!(made + stop.steps().unsigned_abs() <= whole.steps().unsigned_abs());
        }
    }
}

#[test]
fn a_short_smooth_dose_rises_no_faster_than_the_motor_may() {
    let pump = pump(7);
    let mut limits = limits(7);
    limits.motor.max_acceleration_rad_s2 = 15.94;
    let cruise = Cruise::Speed { rad_s: 0.0901 * limits.motor.max_speed_rad_s };
    let request = Request::new(-0.4194, cruise).with_smooth(true);
    let plan = Doser::new(&pump, limits).unwrap().plan(Phase::known(0.0), &request).unwrap();
    // The first leg had 19.4 rad/s².
    let most = plan.legs().map(|leg| leg.acceleration_rad_s2.abs()).fold(0.0, f64::max);
    assert!(most <= 15.94 * (1.0 + 1e-9), "{most}");
}

#[test]
fn predicted_extremes_do_not_reach_beyond_an_edge_of_the_flow() {
    let (pump, limits) = (pump(6), limits(6));
    let at_speed = |rpm: f64| Cruise::Speed { rad_s: rad_s(rpm) };
    // A knot of the smooth flow comes to lie a rounding away from an edge, where the pressure has a kink.
    let top = limits.motor.max_speed_rad_s;
    let request = Request::new(60.346141201613925, Cruise::Speed { rad_s: 0.36863260453305285 * top });
    let whole = Doser::new(&pump, limits).unwrap().plan(Phase::known(0.0), &request).unwrap();
    let made = (0.17231731939757244 * whole.steps().unsigned_abs() as f64) as u64;
    let cruise = Cruise::Speed { rad_s: 0.7863013130830714 * top };
    let rest = Doser::new(&pump, limits)
        .unwrap()
        .retarget(&whole, &Retarget::new(made, request.volume_ml, cruise).with_smooth(true))
        .unwrap();
    let smooth = Doser::new(&pump, limits)
        .unwrap()
        .plan(Phase::known(0.0), &Request::new(40.0, at_speed(130.0)).with_smooth(true))
        .unwrap();
    for (plan, state) in [(smooth, LineState::AT_REST), (rest, state_after(&pump, &whole, made))] {
        let motion_s = plan.profile().duration_s();
        let run = || ExactRun::new(&pump, Port::Outlet, plan.legs(), state);
        let (mut sampled, mut largest) = (run(), 0.0_f64);
        for n in 0..=400_000 {
            largest = largest.max(sampled.pressure_kpa(motion_s * f64::from(n) / 4e5));
        }
        let found = run().extremes(motion_s).max_kpa;
        // Samples 5 us apart miss a kink of some 20 kPa/s by 1e-4 kPa.
        assert!((found - largest).abs() < 1e-4, "{found} found, {largest} sampled");
    }
}

/// Returns the state of the outlet line when `made` steps of `plan` are made, from rest.
fn state_after(pump: &Pump, plan: &Plan, made: u64) -> LineState {
    let time_s = plan.profile().time_of(made as f64 * plan.step_rad());
    ExactRun::from_rest(pump, Port::Outlet, plan.legs()).at(time_s)
}
