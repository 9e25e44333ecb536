//! Claims about doses at the limits of pressure, torque and speed.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use proptest::prelude::*;
use pump_ctl::generated::{torque_curve, torque_points};
use pump_ctl::plan::{
    Cruise, Doser, LimitedBy, Limits, Lowest, Motor, Nearest, Phase, Plan, PlanError, PressureLimits, Ramps,
    Request, SetBy, Torque, TorqueCurve,
};
use pump_ctl::step::Direction;
use pump_model::{ExactRun, Line, Port, Pump};

const TAU: f64 = core::f64::consts::TAU;
const COLLAPSE_KPA: f64 = 42.7;
const AMBIENT_KPA: f64 = 85.7;

fn rad_s(rpm: f64) -> f64 {
    rpm * TAU / 60.0
}

fn rpm(rad_s: f64) -> f64 {
    rad_s * 60.0 / TAU
}

fn limits(max_rpm: f64) -> Limits {
    Limits::new(Motor::new(12_800.0, rad_s(max_rpm), 500.0))
}

fn collapse(max_rpm: f64) -> Limits {
    limits(max_rpm)
        .with_pressures(PressureLimits { min_inlet_kpa: Some(COLLAPSE_KPA), ..PressureLimits::NONE })
}

fn dose(
    pump: &Pump,
    volume_ml: f64,
    start_rad: f64,
    cruise: Cruise,
    limits: &Limits,
) -> Result<Plan, PlanError> {
    Doser::new(pump, *limits).and_then(|doser| {
        doser.plan(Phase::known(start_rad), &Request::new(volume_ml, cruise).with_ramps(Ramps::Fastest))
    })
}

fn speed(rpm: f64) -> Cruise {
    Cruise::Speed { rad_s: rad_s(rpm) }
}

#[test]
fn the_fastest_dose_holds_the_collapse_limit_within_the_speeds_connected_to_rest() {
    let pump = Pump::three_roller();
    let limits = collapse(400.0);
    let fastest = dose(&pump, 100.0, 0.3, Cruise::Fastest, &limits).unwrap();
    let at_rpm = rpm(fastest.profile().peak_rad_s());
    assert_eq!(fastest.limited_by(), LimitedBy::InletSuction);
    assert!(fastest.predict(&pump).unwrap().inlet.min_kpa >= COLLAPSE_KPA);
    let used = limits.margins(&pump, &fastest).inlet.unwrap().used;
    assert!(used <= 1.0 && used > 0.9999, "{used}");
    // The steady state breaks the limit from 222 r/min. Start-up reaches further, so the answer is slower.
    assert!(at_rpm < 222.0 && at_rpm > 100.0, "{at_rpm}");
    // Every slower speed holds the limit, and the next faster speed does not.
    for part in 1..100 {
        let slower = speed(at_rpm * f64::from(part) / 100.0);
        dose(&pump, 100.0, 0.3, slower, &limits).unwrap();
    }
    assert!(dose(&pump, 100.0, 0.3, speed(1.0001 * at_rpm), &limits).is_err());
}

#[test]
fn speeds_that_hold_are_not_an_interval_and_the_fastest_is_below_the_gap() {
    // In the steady state three rollers hold the limit again above 324 r/min. The start is soft, so that
    // start-up reaches no further.
    let pump = Pump::three_roller();
    let mut limits = collapse(400.0);
    limits.motor.max_acceleration_rad_s2 = 10.0;
    let holds = |rpm| pump.steady_state(rad_s(rpm)).unwrap().inlet.min_kpa >= COLLAPSE_KPA;
    assert_eq!([221.0, 223.0, 320.0, 327.0].map(holds), [true, false, false, true]);
    let fastest = dose(&pump, 3000.0, 0.3, Cruise::Fastest, &limits).unwrap();
    assert!(rpm(fastest.profile().peak_rad_s()) < 222.5, "{}", rpm(fastest.profile().peak_rad_s()));
}

#[test]
fn what_breaks_a_limit_is_refused_with_what_can_be_had() {
    let pump = Pump::three_roller();
    let limits = collapse(400.0);
    let refused = |cruise| match dose(&pump, 60.0, 0.3, cruise, &limits) {
        Err(PlanError::InletPressure { predicted_kpa, limit_kpa, nearest, .. }) => {
            assert!(predicted_kpa < limit_kpa && limit_kpa == COLLAPSE_KPA);
            nearest
        }
        other => panic!("{other:?}"),
    };
    let fastest = dose(&pump, 60.0, 0.3, Cruise::Fastest, &limits).unwrap();
    let at_rpm = rpm(fastest.profile().peak_rad_s());

    let Nearest::Speed { rpm } = refused(speed(250.0)) else { panic!() };
    assert!(rpm <= at_rpm && rpm > at_rpm - 0.02, "{rpm} {at_rpm}");
    dose(&pump, 60.0, 0.3, speed(rpm), &limits).unwrap();

    let Nearest::Flow { ml_s } = refused(Cruise::Flow { ml_s: 80.0 }) else { panic!() };
    assert!((ml_s - fastest.cruise_flow_ml_s(&pump)).abs() < 2e-3);
    dose(&pump, 60.0, 0.3, Cruise::Flow { ml_s }, &limits).unwrap();

    let total_s = fastest.profile().duration_s() + fastest.predict(&pump).unwrap().settle_s;
    let Nearest::Within { time_s } = refused(Cruise::Within { time_s: 0.85 * total_s }) else { panic!() };
    assert!((time_s - total_s).abs() < 0.002, "{time_s} {total_s}");
    dose(&pump, 60.0, 0.3, Cruise::Within { time_s }, &limits).unwrap();

    // The refusal of a time that no speed meets names a time that holds the limits too.
    let error = dose(&pump, 60.0, 0.3, Cruise::Within { time_s: 0.1 }, &limits).unwrap_err();
    let PlanError::TimeTooShort { fastest_s, .. } = error else { panic!("{error}") };
    dose(&pump, 60.0, 0.3, Cruise::Within { time_s: fastest_s }, &limits).unwrap();

    let message = dose(&pump, 60.0, 0.3, speed(250.0), &limits).unwrap_err().to_string();
    assert!(message.ends_with("r/min is the fastest that holds every limit"), "{message}");
}

#[test]
fn a_limit_that_rest_breaks_is_refused_whatever_the_speed() {
    let pump = Pump::three_roller();
    let limits =
        limits(170.0).with_pressures(PressureLimits { max_outlet_kpa: Some(80.0), ..PressureLimits::NONE });
    for cruise in [Cruise::Fastest, speed(10.0)] {
        let error = dose(&pump, 25.0, 0.3, cruise, &limits).unwrap_err();
        assert!(matches!(error, PlanError::OutletPressure { nearest: Nearest::RestBreaks, .. }), "{error}");
        assert!(error.to_string().contains("limits are absolute"), "{error}");
    }
}

#[test]
fn without_a_limit_that_binds_the_motor_does() {
    let pump = Pump::three_roller();
    let fastest = |volume_ml| dose(&pump, volume_ml, 0.3, Cruise::Fastest, &limits(170.0)).unwrap();
    assert_eq!(fastest(60.0).limited_by(), LimitedBy::Speed);
    assert!((fastest(60.0).profile().peak_rad_s() - rad_s(170.0)).abs() < 1e-9);
    assert_eq!(fastest(0.2).limited_by(), LimitedBy::Acceleration);
    // A limit that is far away changes nothing.
    let far =
        limits(170.0).with_pressures(PressureLimits { min_inlet_kpa: Some(1.0), ..PressureLimits::NONE });
    let with = |volume_ml| dose(&pump, volume_ml, 0.3, Cruise::Fastest, &far).unwrap().limited_by();
    assert_eq!((with(60.0), with(0.2)), (LimitedBy::Speed, LimitedBy::Acceleration));
}

#[test]
fn smoothing_the_outlet_worsens_the_inlet_whose_limit_refuses_it() {
    let pump = Pump::three_roller();
    for rpm in [20.0, 50.0] {
        let even = Request::new(60.0, speed(rpm));
        let with = |request: Request, min_inlet_kpa| {
            Doser::new(
                &pump,
                limits(170.0).with_pressures(PressureLimits { min_inlet_kpa, ..PressureLimits::NONE }),
            )
            .and_then(|doser| doser.plan(Phase::known(0.3), &request))
        };
        let least_kpa = |request| with(request, None).unwrap().predict(&pump).unwrap().inlet.min_kpa;
        let (before_kpa, after_kpa) = (least_kpa(even), least_kpa(even.with_smooth(true)));
        assert!(after_kpa < before_kpa, "{after_kpa} {before_kpa} at {rpm} r/min");
        let between_kpa = Some(0.5 * (before_kpa + after_kpa));
        with(even, between_kpa).unwrap();
        let refused = with(even.with_smooth(true), between_kpa).unwrap_err();
        let PlanError::InletPressure { nearest: Nearest::Speed { rpm }, .. } = refused else {
            panic!("{refused}")
        };
        with(even.with_smooth(true).with_cruise(speed(rpm)), between_kpa).unwrap();
    }
}

#[test]
fn a_long_dose_has_the_margins_that_following_every_pitch_gives() {
    let pump = Pump::two_roller();
    let limits = limits(300.0)
        .with_pressures(PressureLimits { max_outlet_kpa: Some(150.0), min_inlet_kpa: Some(20.0) });
    for (volume_ml, rpm, smooth) in [(2000.0, 150.0, false), (-1500.0, 90.0, true), (900.0, 40.0, true)] {
        let request = Request::new(volume_ml, speed(rpm)).with_smooth(smooth);
        let plan = Doser::new(&pump, limits).unwrap().plan(Phase::known(1.1), &request).unwrap();
        let margins = limits.margins(&pump, &plan);
        let all = |port| {
            ExactRun::from_rest(&pump, port, plan.legs()).extremes_to_rest(plan.profile().duration_s())
        };
        let (inlet, outlet) = (all(Port::Inlet), all(Port::Outlet));
        let (sucking, pushing) = if volume_ml > 0.0 { (inlet, outlet) } else { (outlet, inlet) };
        let predicted = plan.predict(&pump).unwrap();
        let steps = predicted.step_kpa;
        let near =
            |found: f64, expected: f64| assert!((found - expected).abs() < 1e-8, "{margins:?} {predicted:?}");
        near(margins.outlet.unwrap().reached, pushing.max_kpa + steps);
        near(margins.inlet.unwrap().reached, sucking.min_kpa - steps);
        near(predicted.inlet.min_kpa, inlet.min_kpa);
        near(predicted.outlet.max_kpa, outlet.max_kpa);
    }
}

#[test]
fn limits_hold_from_wherever_the_rollers_may_stand() {
    let pump = Pump::three_roller();
    let pitch_rad = pump.pitch_rad();
    let limits = limits(170.0)
        .with_pressures(PressureLimits { max_outlet_kpa: Some(150.0), min_inlet_kpa: Some(20.0) });
    let request = Request::new(60.0, speed(150.0));
    for half_width_rad in [0.5 * pitch_rad, 0.1 * pitch_rad, 0.01] {
        let start = Phase::within(0.4, half_width_rad);
        let planned = Doser::new(&pump, limits).unwrap().plan(start, &request).unwrap();
        let margins = limits.margins(&pump, &planned);
        let predicted = planned.predict(&pump).unwrap();
        let (reached_kpa, fell_kpa) = (margins.outlet.unwrap().reached, margins.inlet.unwrap().reached);
        let (mut most_kpa, mut least_kpa) = (0.0_f64, f64::INFINITY);
        for n in -50..=50 {
            let off_rad = half_width_rad * f64::from(n) / 50.0;
            let run = |port| {
                let legs = planned.legs().map(|leg| leg.beside(off_rad));
                ExactRun::from_rest(&pump, port, legs).extremes_to_rest(planned.profile().duration_s())
            };
            most_kpa = most_kpa.max(run(Port::Outlet).max_kpa);
            least_kpa = least_kpa.min(run(Port::Inlet).min_kpa);
        }
        // Looks a sixteenth of a pitch apart miss some tenths of a kilopascal at most.
        assert!((predicted.outlet.max_kpa - most_kpa).abs() < 0.3, "{predicted:?} {most_kpa}");
        assert!((predicted.inlet.min_kpa - least_kpa).abs() < 0.3, "{predicted:?} {least_kpa}");
        assert!(reached_kpa > predicted.outlet.max_kpa && fell_kpa < predicted.inlet.min_kpa);
    }
    let unknown = Doser::new(&pump, limits)
        .unwrap()
        .plan(Phase::unknown(pitch_rad), &request)
        .unwrap()
        .predict(&pump)
        .unwrap();
    let middle =
        Doser::new(&pump, limits).unwrap().plan(Phase::known(0.0), &request).unwrap().predict(&pump).unwrap();
    assert!(unknown.outlet.max_kpa > middle.outlet.max_kpa + 5.0, "{unknown:?} {middle:?}");
    // A limit that holds from the middle and breaks from another angle refuses the dose.
    let between = 0.5 * (unknown.outlet.max_kpa + middle.outlet.max_kpa);
    let limits = limits.with_pressures(PressureLimits { max_outlet_kpa: Some(between), ..limits.pressures });
    assert!(Doser::new(&pump, limits).and_then(|doser| doser.plan(Phase::known(0.0), &request)).is_ok());
    let refused = Doser::new(&pump, limits)
        .and_then(|doser| doser.plan(Phase::unknown(pitch_rad), &request))
        .unwrap_err();
    let PlanError::OutletPressure { nearest: Nearest::Speed { rpm }, .. } = refused else {
        panic!("{refused}")
    };
    Doser::new(&pump, limits)
        .unwrap()
        .plan(Phase::unknown(pitch_rad), &Request::new(60.0, speed(rpm)))
        .unwrap();
}

#[test]
fn a_long_heavy_outlet_line_sucks_where_the_flow_falls() {
    let pump = Pump::three_roller();
    let heavy = Line { inertance_kpa_s2_ml: 4.0 * Line::PUBLISHED.inertance_kpa_s2_ml, ..Line::PUBLISHED };
    let pump = Pump::new(*pump.geometry(), *pump.roller_volume(), *pump.inlet(), heavy).unwrap();
    let lowest = Lowest { kpa: COLLAPSE_KPA, set_by: SetBy::TubeCollapse };
    let limits = limits(170.0).with_lowest(lowest);
    let refused = dose(&pump, 60.0, 0.3, speed(150.0), &limits).unwrap_err();
    let PlanError::OutletSuction { predicted_kpa, nearest: Nearest::Speed { rpm }, .. } = refused else {
        panic!("{refused}")
    };
    assert!(predicted_kpa < COLLAPSE_KPA, "{predicted_kpa}");
    let message = refused.to_string();
    assert!(
        message.contains("runs on, below the limit of 42.70 kPa, at which the tube would collapse"),
        "{message}"
    );
    dose(&pump, 60.0, 0.3, speed(rpm), &limits).unwrap();
    let fastest = dose(&pump, 60.0, 0.3, Cruise::Fastest, &limits).unwrap();
    assert_eq!(fastest.limited_by(), LimitedBy::OutletSuction);
}

#[test]
fn the_limit_that_binds_is_named_by_its_port_and_its_side_in_both_directions() {
    let heavy = Line { inertance_kpa_s2_ml: 4.0 * Line::PUBLISHED.inertance_kpa_s2_ml, ..Line::PUBLISHED };
    let three = Pump::three_roller();
    let with = |inlet, outlet| Pump::new(*three.geometry(), *three.roller_volume(), inlet, outlet).unwrap();
    let pressures = |pressures, lowest| {
        let mut limits = limits(170.0);
        (limits.pressures, limits.lowest) = (pressures, lowest);
        limits
    };
    let highest = pressures(PressureLimits { max_outlet_kpa: Some(100.0), ..PressureLimits::NONE }, None);
    let sucking = pressures(PressureLimits { min_inlet_kpa: Some(75.0), ..PressureLimits::NONE }, None);
    let falling =
        pressures(PressureLimits::NONE, Some(Lowest { kpa: COLLAPSE_KPA, set_by: SetBy::TubeCollapse }));
    for (pump, limits, forward, reverse) in [
        (three, highest, LimitedBy::OutletPressure, LimitedBy::InletPressure),
        (three, sucking, LimitedBy::InletSuction, LimitedBy::OutletSuction),
        (with(*three.inlet(), heavy), falling, LimitedBy::OutletSuction, LimitedBy::OutletSuction),
        (with(heavy, *three.outlet()), falling, LimitedBy::InletSuction, LimitedBy::InletSuction),
    ] {
        for (volume_ml, limited_by, direction) in
            [(60.0, forward, Direction::Forward), (-60.0, reverse, Direction::Reverse)]
        {
            let fastest = dose(&pump, volume_ml, 0.3, Cruise::Fastest, &limits).unwrap();
            assert_eq!(fastest.limited_by(), limited_by, "{volume_ml} mL, {limits:?}");
            let (nearest, margin) = limits.margins(&pump, &fastest).nearest(direction).unwrap();
            assert_eq!(nearest, limited_by);
            assert!(margin.used <= 1.0 && margin.used > 0.99, "{margin:?}");
        }
    }
}

#[test]
fn an_offer_has_digits_however_slow_and_can_be_had() {
    let pump = Pump::three_roller();
    // The flow is some microlitres a second, for an outlet limit hardly above the reservoir and a motor step.
    let free = dose(&pump, 5.0, 0.3, speed(1.0), &limits(170.0)).unwrap();
    let max_kpa = Line::PUBLISHED.reservoir_kpa + free.predict(&pump).unwrap().step_kpa + 1e-3;
    let limits = limits(170.0)
        .with_pressures(PressureLimits { max_outlet_kpa: Some(max_kpa), ..PressureLimits::NONE });
    let refused = dose(&pump, 5.0, 0.3, Cruise::Flow { ml_s: 5.0 }, &limits).unwrap_err();
    let PlanError::OutletPressure { nearest: Nearest::Flow { ml_s }, .. } = refused else {
        panic!("{refused}")
    };
    assert!(ml_s > 0.0 && ml_s < 0.01, "{ml_s}");
    assert!(refused.to_string().contains(&format!("{ml_s} mL/s is the fastest")), "{refused}");
    dose(&pump, 5.0, 0.3, Cruise::Flow { ml_s }, &limits).unwrap();
}

fn torque(occlusion_n_m: f64, points: &[(f64, f64)]) -> Torque {
    let curve = TorqueCurve::new(points).unwrap();
    Torque::new(AMBIENT_KPA, curve).with_occlusion_n_m(occlusion_n_m).with_inertia_kg_m2(2e-4)
}

/// Returns the largest part of the motor's torque that the dose needs, from looks at many times.
fn worst_used(pump: &Pump, plan: &Plan, torque: &Torque) -> f64 {
    let mut runs = [Port::Inlet, Port::Outlet].map(|port| ExactRun::from_rest(pump, port, plan.legs()));
    let mut worst = 0.0_f64;
    for leg in plan.legs() {
        let looks = 1.0 + (leg.duration_s * 2e4).ceil();
        for look in 0..=looks as u32 {
            let t = leg.start_s + leg.duration_s * f64::from(look) / looks;
            let work = [Port::Inlet, Port::Outlet].map(|port| {
                let kpa = runs[usize::from(port == Port::Outlet)].pressure_kpa(t) - torque.ambient_kpa;
                kpa * pump.curve(port).flow_ml_rad(leg.angle_at(t))
            });
            let shaft = 1e-3 * (work[1] - work[0]) + torque.inertia_kg_m2 * leg.acceleration_rad_s2;
            let needed = f64::from(plan.direction().sign()) * shaft + torque.occlusion_n_m;
            worst = worst.max(needed.abs() / torque.motor.at(leg.speed_at(t).abs()));
        }
    }
    worst
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, ..ProptestConfig::default() })]

    #[test]
    fn the_torques_margin_is_that_of_ten_times_as_many_looks(
        volume in 2.0..60.0_f64,
        reverse in any::<bool>(),
        smooth in any::<bool>(),
        start in 0.0..6.2_f64,
        rpm in 5.0..170.0_f64,
        occlusion in 0.0..2.0_f64,
    ) {
        let pump = Pump::three_roller();
        let torque = torque(occlusion, &[(0.0, 10.0), (10.0, 6.0), (60.0, 3.0)]);
        let limits = limits(170.0).with_torque(torque);
        let volume = if reverse { -volume } else { volume };
        let request = Request::new(volume, speed(rpm)).with_smooth(smooth);
        let plan = Doser::new(&pump, limits).unwrap().plan(Phase::known(start), &request).unwrap();
        let found = limits.margins(&pump, &plan).torque.unwrap();
        let expected = worst_used(&pump, &plan, &torque);
        prop_assert!((found.used / expected - 1.0).abs() < 2e-3, "{found:?} {expected}");
    }
}

#[test]
fn the_fluids_torque_at_150_rpm_is_about_two_tenths_of_a_newton_metre() {
    let pump = Pump::three_roller();
    let torque = torque(0.0, &[(0.0, 5.0), (60.0, 5.0)]).with_inertia_kg_m2(0.0);
    let limits = limits(170.0).with_torque(torque);
    let plan = dose(&pump, 200.0, 0.3, speed(150.0), &limits).unwrap();
    let needed = limits.margins(&pump, &plan).torque.unwrap().reached;
    assert!((0.1..0.3).contains(&needed), "{needed} N m");
}

#[test]
fn the_motors_torque_binds_and_is_never_passed() {
    let pump = Pump::three_roller();
    let torque = torque(0.5, &[(0.0, 1.2), (5.0, 1.0), (15.0, 0.62)]);
    let limits = limits(170.0).with_torque(torque);
    let fastest = dose(&pump, 60.0, 0.3, Cruise::Fastest, &limits).unwrap();
    assert_eq!(fastest.limited_by(), LimitedBy::Torque);
    assert!(worst_used(&pump, &fastest, &torque) < 1.002);
    assert!(fastest.profile().peak_rad_s() < 15.0);
    let error = dose(&pump, 60.0, 0.3, speed(160.0), &limits).unwrap_err();
    let PlanError::Torque { nearest: Nearest::Speed { rpm }, limit_n_m, .. } = error else {
        panic!("{error}")
    };
    assert_eq!(limit_n_m, 0.0, "the motor has nothing beyond its last point");
    dose(&pump, 60.0, 0.3, speed(rpm), &limits).unwrap();
}

#[test]
fn torque_curves_that_mean_nothing_are_refused() {
    let refused: [&[(f64, f64)]; 6] = [
        &[],
        &[(0.0, 1.0)],
        &[(1.0, 1.0), (2.0, 1.0)],
        &[(0.0, 1.0), (0.0, 2.0)],
        &[(0.0, 1.0), (5.0, -1.0)],
        &[(0.0, 1.0), (f64::NAN, 1.0)],
    ];
    for points in refused {
        assert_eq!(TorqueCurve::new(points), None, "{points:?}");
    }
    assert_eq!(TorqueCurve::new(&[(0.0, 1.0); 9]), None);
    let curve = TorqueCurve::new(&[(0.0, 2.0), (10.0, 1.0)]).unwrap();
    assert_eq!([0.0, 5.0, 10.0, 10.1].map(|speed| curve.at(speed)), [2.0, 1.5, 1.0, 0.0]);
    assert_eq!(curve.at(10.0 + 1e-12), 1.0, "a speed at the end of the curve may round");
    let points = torque_points(&curve);
    assert_eq!(torque_curve(points), Some(curve));
    for place in 0..points.len() {
        let mut damaged = points;
        damaged[place].0 = f64::NAN;
        assert_eq!(torque_curve(damaged), None, "{damaged:?}");
    }
}
