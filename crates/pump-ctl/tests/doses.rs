//! Claims about planned doses, over random volumes, start angles, pumps and directions.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use proptest::prelude::*;
use pump_ctl::plan::{
    Cruise, Doser, LimitedBy, Limits, Motor, Phase, Plan, PlanError, PressureLimits, Ramps, Request,
    speed_for_flow,
};
use pump_model::Pump;

const TAU: f64 = core::f64::consts::TAU;

fn rad_s(rpm: f64) -> f64 {
    rpm * TAU / 60.0
}

/// The motor of the built-in pumps.
fn limits(rollers: u32) -> Limits {
    let max_rpm = if rollers == 3 { 170.0 } else { 300.0 };
    Limits::new(Motor::new(12_800.0, rad_s(max_rpm), 500.0))
}

fn pump(rollers: u32) -> Pump {
    if rollers == 3 { Pump::three_roller() } else { Pump::two_roller() }
}

/// A dose as (rollers, volume in mL, start angle in rad).
fn any_dose() -> impl Strategy<Value = (u32, f64, f64)> {
    (2u32..=3, 0.5..500.0_f64, any::<bool>(), 0.0..TAU).prop_map(|(rollers, volume, reverse, start)| {
        (rollers, if reverse { -volume } else { volume }, start)
    })
}

fn planned(rollers: u32, volume_ml: f64, start_rad: f64, cruise: Cruise) -> Plan {
    Doser::new(&pump(rollers), limits(rollers))
        .unwrap()
        .plan(Phase::known(start_rad), &Request::new(volume_ml, cruise).with_ramps(Ramps::Fastest))
        .unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 10_000, ..ProptestConfig::default() })]

    #[test]
    fn dose_from_any_start_angle_lands_within_half_a_step(
        (rollers, volume, start) in any_dose(),
        rpm in 1.0..170.0_f64,
    ) {
        let pump = pump(rollers);
        let curve = pump.outlet_curve();
        let slow = planned(rollers, volume, start, Cruise::Flow { ml_s: 5.0 });

        // These are both ends of the step that contains the ideal end angle.
        let ideal = (curve.angle_rad(curve.volume_ml(start) + volume) - start) / slow.step_rad();
        let [below, above] = [ideal.floor(), ideal.floor() + 1.0].map(|n| curve.volume_ml(start + n * slow.step_rad()));
        prop_assert!(slow.carry_ml().abs() <= 0.5 * (above - below) + 1e-12);
        prop_assert!((slow.planned_ml() + slow.carry_ml() - volume).abs() < 1e-12);
        let delivered = curve.volume_ml(slow.end_angle_rad()) - curve.volume_ml(start);
        prop_assert!((delivered - slow.planned_ml()).abs() < 1e-12);
        prop_assert_eq!(slow.steps() < 0, volume < 0.0);

        let other = planned(rollers, volume, start, Cruise::Speed { rad_s: rad_s(rpm) });
        prop_assert_eq!(other.steps(), slow.steps());
        prop_assert_eq!(other.end_angle_rad().to_bits(), slow.end_angle_rad().to_bits());
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    #[test]
    fn steps_are_exact_in_number_rise_in_time_and_keep_the_acceleration(
        (rollers, volume, start) in any_dose(),
        rpm in 0.5..170.0_f64,
    ) {
        let plan = planned(rollers, volume, start, Cruise::Speed { rad_s: rad_s(rpm) });
        let steps: Vec<_> = plan.each_step().collect();
        prop_assert_eq!(steps.len() as u64, plan.steps().unsigned_abs());
        prop_assert_eq!(plan.each_step().size_hint().0, steps.len());

        let mut points = vec![(0.0, start)];
        for (n, step) in steps.iter().enumerate() {
            prop_assert_eq!(step.number, n as u64 + 1);
            prop_assert_eq!(step.direction, plan.direction());
            prop_assert!(step.time_s > points[n].0);
            points.push((step.time_s, step.angle_rad));
        }
        prop_assert_eq!(points.last().unwrap().1.to_bits(), plan.end_angle_rad().to_bits());
        prop_assert_eq!(points.last().unwrap().0.to_bits(), plan.profile().duration_s().to_bits());
        for three in points.windows(3) {
            let rate = |a: (f64, f64), b: (f64, f64)| (b.1 - a.1) / (b.0 - a.0);
            let second = (rate(three[1], three[2]) - rate(three[0], three[1])) / (three[2].0 - three[0].0);
            prop_assert!((2.0 * second).abs() <= 505.0, "{} rad/s2 at {} s", 2.0 * second, three[1].0);
        }
        // The look is at the cruise, away from the ramps.
        if plan.limited_by() == LimitedBy::Nothing {
            let ramp = rad_s(rpm) / 500.0;
            let cruise: Vec<_> = points
                .iter()
                .filter(|point| point.0 > ramp && point.0 < plan.profile().duration_s() - ramp)
                .collect();
            if cruise.len() > 100 {
                let (first, last) = (cruise[0], cruise[cruise.len() - 1]);
                let speed = ((last.1 - first.1) / (last.0 - first.0)).abs();
                prop_assert!((speed / rad_s(rpm) - 1.0).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn the_inverse_of_the_average_flow_gives_the_flow_back(rollers in 2u32..=3, flow in 1e-3..100.0_f64) {
        let pump = pump(rollers);
        let speed = speed_for_flow(&pump, flow);
        prop_assert!((pump.average_flow_ml_s(speed) / flow - 1.0).abs() < 1e-14);
    }

    #[test]
    fn the_motion_passes_every_step_at_its_time((rollers, volume, start) in any_dose(), rpm in 0.5..170.0_f64) {
        let plan = planned(rollers, volume, start, Cruise::Speed { rad_s: rad_s(rpm) });
        let legs: Vec<_> = plan.legs().collect();
        for step in plan.each_step().step_by(97) {
            let leg = legs.iter().rev().find(|leg| leg.start_s <= step.time_s).unwrap();
            prop_assert!((leg.angle_at(step.time_s) - step.angle_rad).abs() < 1e-9);
            prop_assert!((plan.angle_at(step.time_s) - step.angle_rad).abs() < 1e-9);
            prop_assert!((plan.speed_at(step.time_s) - leg.speed_at(step.time_s)).abs() < 1e-6);
        }
        let (before, after) = (-1.0, plan.profile().duration_s() + 1.0);
        prop_assert_eq!((plan.angle_at(before), plan.speed_at(before)), (plan.start().angle_rad(), 0.0));
        prop_assert!((plan.angle_at(after) - plan.end_angle_rad()).abs() < 1e-9);
        prop_assert_eq!(plan.speed_at(after), 0.0);
    }
}

#[test]
fn a_rate_beyond_the_motor_is_refused_with_the_largest_that_can_be_had() {
    let request = Request::new(25.0, Cruise::Flow { ml_s: 100.0 });
    let error = Doser::new(&pump(3), limits(3))
        .and_then(|doser| doser.plan(Phase::known(0.0), &request))
        .unwrap_err();
    assert_eq!(
        error.to_string(),
        "a rate of 100 mL/s needs 281.45 r/min; the pump's limit of 170.00 r/min gives 60.402 mL/s at most"
    );
    let request = Request::new(25.0, Cruise::Speed { rad_s: rad_s(171.0) });
    assert!(matches!(
        Doser::new(&pump(3), limits(3)).and_then(|doser| doser.plan(Phase::known(0.0), &request)),
        Err(PlanError::SpeedTooHigh { .. })
    ));
    let at_the_limit = Request::new(25.0, Cruise::Speed { rad_s: rad_s(170.0) });
    assert!(
        Doser::new(&pump(3), limits(3))
            .and_then(|doser| doser.plan(Phase::known(0.0), &at_the_limit))
            .is_ok()
    );
}

#[test]
fn within_is_met_by_the_slowest_cruise() {
    let total_s = |cruise| {
        let plan = planned(3, 25.0, 0.4, cruise);
        let total_s = plan.profile().duration_s() + plan.predict(&pump(3)).unwrap().settle_s;
        (plan, total_s)
    };
    for time_s in [1.2, 2.0, 6.0, 60.0] {
        let (plan, took_s) = total_s(Cruise::Within { time_s });
        assert!(took_s <= time_s, "{took_s} for {time_s}");
        let slower = plan.profile().peak_rad_s() * 0.9999;
        assert!(total_s(Cruise::Speed { rad_s: slower }).1 > time_s, "not the slowest for {time_s}");
    }
    // A request for the fastest dose that the refusal names is accepted.
    let refused = Request::new(25.0, Cruise::Within { time_s: 0.5 }).with_ramps(Ramps::Fastest);
    let error = Doser::new(&pump(3), limits(3))
        .and_then(|doser| doser.plan(Phase::known(0.4), &refused))
        .unwrap_err();
    let PlanError::TimeTooShort { fastest_s, .. } = error else { panic!("{error}") };
    let (_, took_s) = total_s(Cruise::Within { time_s: fastest_s });
    assert!(took_s <= fastest_s && took_s > fastest_s - 0.002, "{took_s} for {fastest_s}");
}

#[test]
fn a_dose_too_short_for_its_speed_says_so_and_keeps_the_acceleration() {
    let plan = planned(3, 0.5, 1.0, Cruise::Speed { rad_s: rad_s(170.0) });
    assert_eq!(plan.limited_by(), LimitedBy::Acceleration);
    assert!(plan.profile().peak_rad_s() < rad_s(170.0));
}

#[test]
fn pressure_limits_refuse_what_would_break_them_in_either_direction() {
    let cruise = Cruise::Speed { rad_s: rad_s(100.0) };
    for volume_ml in [60.0, -60.0] {
        let free = planned(3, volume_ml, 0.0, cruise).predict(&pump(3)).unwrap();
        let (sucking, pushing) =
            if volume_ml > 0.0 { (free.inlet, free.outlet) } else { (free.outlet, free.inlet) };
        let with = |max_outlet_kpa, min_inlet_kpa| {
            let limits = limits(3).with_pressures(PressureLimits { max_outlet_kpa, min_inlet_kpa });
            Doser::new(&pump(3), limits).and_then(|doser| {
                let request = Request::new(volume_ml, cruise).with_ramps(Ramps::Fastest);
                doser.plan(Phase::known(0.0), &request)
            })
        };
        // A motor step moves the pressure by so much beyond the prediction.
        let room_kpa = free.step_kpa + 0.01;
        assert!(with(Some(pushing.max_kpa + room_kpa), Some(sucking.min_kpa - room_kpa)).is_ok());
        assert!(matches!(with(Some(pushing.max_kpa - 0.01), None), Err(PlanError::OutletPressure { .. })));
        assert!(matches!(with(None, Some(sucking.min_kpa + 0.01)), Err(PlanError::InletPressure { .. })));
    }
}

#[test]
fn absurd_requests_are_refused_by_name() {
    let flow = Cruise::Flow { ml_s: 5.0 };
    let refused = |volume, start, cruise| {
        Doser::new(&pump(3), limits(3))
            .and_then(|doser| doser.plan(Phase::known(start), &Request::new(volume, cruise)))
            .unwrap_err()
            .to_string()
    };
    for volume in [0.0, f64::NAN, f64::INFINITY, -1e9, 1e300] {
        assert!(refused(volume, 0.0, flow).starts_with("volume in mL is"), "{volume}");
    }
    assert!(refused(25.0, f64::NAN, flow).starts_with("start angle in rad is NaN"));
    for rate in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(refused(25.0, 0.0, Cruise::Flow { ml_s: rate }).starts_with("rate in mL/s is"), "{rate}");
    }
    assert!(refused(25.0, 0.0, Cruise::Flow { ml_s: 1e-9 }).contains("58 days"));
    assert_eq!(
        refused(0.0001, 0.0, flow),
        "0.100 µL with 0 mL carried from earlier doses is less than half a motor step at this angle; the smallest \
         dose here is 1.052 µL"
    );
}

#[test]
fn turning_by_the_mean_volume_is_wrong_by_the_known_amounts() {
    // Each row is (rollers, [(mL, largest error %, RMS error %)]) over all start angles, computed
    // independently.
    let table = [
        (3, [(1.0, 81.7, 39.9), (5.0, 26.0, 13.8), (10.0, 12.5, 7.9), (25.0, 4.4, 3.3), (100.0, 0.44, 0.22)]),
        (2, [(1.0, 84.3, 32.6), (5.0, 24.1, 17.7), (10.0, 12.9, 5.1), (25.0, 4.9, 1.9), (100.0, 1.13, 0.90)]),
    ];
    for (rollers, rows) in table {
        let pump = pump(rollers);
        let curve = pump.outlet_curve();
        for (volume_ml, largest, rms) in rows {
            let turn_rad = volume_ml / pump.revolution_ml() * TAU;
            let errors = (0..20_000).map(|n| {
                let start = f64::from(n) / 20_000.0 * pump.pitch_rad();
                100.0 * ((curve.volume_ml(start + turn_rad) - curve.volume_ml(start)) / volume_ml - 1.0)
            });
            let (worst, square) = errors.fold((0.0_f64, 0.0), |(worst, square), error| {
                (worst.max(error.abs()), square + error * error)
            });
            assert!((worst / largest - 1.0).abs() < 0.015, "{rollers} rollers, {volume_ml} mL: {worst} %");
            assert!(
                ((square / 20_000.0).sqrt() / rms - 1.0).abs() < 0.025,
                "{rollers} rollers, {volume_ml} mL"
            );
        }
    }
}
