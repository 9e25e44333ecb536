//! Claims about the roller-centric model: its limit, its balance, its segments.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use pump_model::units::{TURN_RAD, rad_s};
use pump_model::{
    DEFAULT_TOLERANCE, ExactRun, Leg, Line, ModelError, Parameter, Port, Pump, RollerCentric, RollerRun,
    SpeedLaw, Variant,
};

/// Returns the parameters with which the model becomes flow-centric as D and R_v vanish.
fn limit(pump: &Pump, distensibility_per_kpa: f64, valve_resistance_kpa_s_ml: f64) -> RollerCentric {
    RollerCentric {
        scale: 1.0,
        distensibility_per_kpa,
        valve_resistance_kpa_s_ml,
        closure_rad: pump.roller_volume().engagement_rad(),
        ..RollerCentric::PUBLISHED
    }
}

fn preset(rollers: u32) -> Pump {
    Pump::preset(rollers, Variant::Measured).unwrap()
}

fn at_rpm(rpm: f64) -> [Leg; 1] {
    [Leg::constant_speed(0.0, rad_s(rpm))]
}

/// Returns a motion up to 15 rad/s in 0.2 s, on for 0.3 s, down through a stop to -15 rad/s, and rest.
fn there_and_back() -> [Leg; 3] {
    let leg = |start_s, duration_s, angle_rad, speed_rad_s, acceleration_rad_s2| Leg {
        start_s,
        duration_s,
        angle_rad,
        speed_rad_s,
        acceleration_rad_s2,
    };
    [leg(0.0, 0.2, 0.4, 0.0, 75.0), leg(0.2, 0.3, 1.9, 15.0, 0.0), leg(0.5, 0.6, 6.4, 15.0, -50.0)]
}

/// Returns the root mean square deviation of inlet and outlet from the flow-centric model over a motion from
/// rest, kPa, every millisecond.
fn rmse_kpa(pump: &Pump, model: RollerCentric, legs: &[Leg], samples: u32) -> [f64; 2] {
    let legs = || legs.iter().copied();
    let mut run = RollerRun::new(pump, model, legs(), DEFAULT_TOLERANCE).unwrap();
    let mut exact = [Port::Inlet, Port::Outlet].map(|port| ExactRun::from_rest(pump, port, legs()));
    let mut squares = [0.0; 2];
    for n in 0..=samples {
        let t_s = f64::from(n) * 1e-3;
        let sample = run.at(t_s).unwrap();
        let found = [sample.inlet_kpa, sample.outlet_kpa];
        for ((square, found), exact) in squares.iter_mut().zip(found).zip(&mut exact) {
            let off = found - Line::PUBLISHED.reservoir_kpa - exact.at(t_s).above_reservoir_kpa;
            *square += off * off;
        }
    }
    squares.map(|square| (square / f64::from(samples + 1)).sqrt())
}

#[test]
fn without_swelling_and_leaks_it_is_the_flow_centric_model() {
    for rollers in [2, 3] {
        let pump = preset(rollers);
        let off = rmse_kpa(&pump, limit(&pump, 1e-7, 1e-6), &at_rpm(100.0), 10_000);
        assert!(off.iter().all(|off| *off <= 0.002), "{rollers} rollers: {off:?}");
    }
}

#[test]
fn the_limit_holds_for_up_to_twelve_rollers_and_for_ramps_and_reversals() {
    for rollers in [2, 3, 4, 5, 8, 12] {
        let pump = preset(rollers);
        for legs in [&at_rpm(100.0)[..], &at_rpm(-100.0), &there_and_back()] {
            let off = rmse_kpa(&pump, limit(&pump, 1e-8, 1e-6), legs, 1000);
            assert!(off.iter().all(|off| *off <= 0.003), "{rollers} rollers: {off:?}");
        }
    }
}

#[test]
fn it_nears_the_limit_with_the_fourth_root_of_swelling_and_leaks() {
    for rollers in [2, 3] {
        let pump = preset(rollers);
        let off = |d, r_v| rmse_kpa(&pump, limit(&pump, d, r_v), &at_rpm(100.0), 2000);
        let near = off(1e-9, 1e-6);
        for farther in [off(16e-9, 1e-6), off(1e-9, 16e-6)] {
            for (near, farther) in near.iter().zip(farther) {
                assert!((farther / near - 2.0).abs() < 0.15, "{rollers} rollers: {farther} / {near}");
            }
        }
    }
}

#[test]
fn what_is_delivered_and_stored_was_taken_over_every_revolution() {
    for (rollers, rpm) in [(2, 100.0), (3, 100.0), (3, -40.0), (8, 100.0)] {
        let pump = preset(rollers);
        let mut run = RollerRun::new(&pump, RollerCentric::PUBLISHED, at_rpm(rpm), 1e-9).unwrap();
        let (mut taken_ml, mut delivered_ml, mut stored_ml) = (0.0, 0.0, run.stored_ml());
        let revolution_s = 60.0 / f64::abs(rpm);
        for revolution in 1..=12 {
            let end_s = f64::from(revolution) * revolution_s;
            run.run_to(end_s).unwrap();
            let sample = run.at(end_s).unwrap();
            let (took_ml, gave_ml) = (sample.taken_ml - taken_ml, sample.delivered_ml - delivered_ml);
            let grew_ml = run.stored_ml() - stored_ml;
            assert!(gave_ml.abs() > 1.0 || revolution == 1, "{rollers} rollers: {gave_ml}");
            assert!(
                (took_ml - gave_ml - grew_ml).abs() < 1e-6 * took_ml.abs(),
                "{took_ml} {gave_ml} {grew_ml}"
            );
            if revolution == 12 {
                // Start-up is forgotten by now.
                assert!((took_ml / gave_ml - 1.0).abs() < 1e-6, "{rollers} rollers: {took_ml} {gave_ml}");
            }
            (taken_ml, delivered_ml, stored_ml) = (sample.taken_ml, sample.delivered_ml, run.stored_ml());
        }
    }
}

#[test]
fn volumes_balance_through_ramps_and_reversals() {
    let pump = preset(3);
    let mut run = RollerRun::new(&pump, RollerCentric::PUBLISHED, there_and_back(), 1e-9).unwrap();
    let before_ml = run.stored_ml();
    for n in 1..=40 {
        let t_s = 0.05 * f64::from(n);
        run.run_to(t_s).unwrap();
        let sample = run.at(t_s).unwrap();
        let off_ml = sample.taken_ml - sample.delivered_ml - (run.stored_ml() - before_ml);
        assert!(off_ml.abs() < 1e-7, "{off_ml} mL at {t_s} s");
    }
}

#[test]
fn the_steady_state_is_that_of_a_long_run_and_obeys_the_mean() {
    for (rollers, rpm) in [(3, 100.0), (2, 300.0), (3, -100.0)] {
        let pump = preset(rollers);
        let steady = RollerCentric::PUBLISHED.steady_state(&pump, rad_s(rpm)).unwrap();
        let mut run = RollerRun::new(&pump, RollerCentric::PUBLISHED, at_rpm(rpm), 1e-9).unwrap();
        let revolution_s = 60.0 / rpm.abs();
        let before_ml = run.at(20.0 * revolution_s).unwrap().delivered_ml;
        let after_ml = run.at(21.0 * revolution_s).unwrap().delivered_ml;
        let mean_ml_s = (after_ml - before_ml) / revolution_s;
        assert!((steady.mean_flow_ml_s / mean_ml_s - 1.0).abs() < 1e-5, "{rollers} at {rpm}: {mean_ml_s}");
        // The mean of L dQ/dt over a period is 0.
        let drop_kpa = Line::PUBLISHED.resistance_kpa_s_ml * mean_ml_s;
        assert!((steady.outlet_mean_kpa - Line::PUBLISHED.reservoir_kpa - drop_kpa).abs() < 1e-3);
        assert!((steady.inlet_mean_kpa - Line::PUBLISHED.reservoir_kpa + drop_kpa).abs() < 1e-3);
    }
}

#[test]
fn a_revolution_delivers_about_three_percent_more_than_the_speed_law_and_less_so_with_tighter_rollers() {
    for (rollers, rpm, percent) in [(3, 100.0, 3.2), (2, 100.0, 2.2), (3, 170.0, 2.1)] {
        let pump = preset(rollers);
        let law_ml = SpeedLaw::PUBLISHED.revolution_ml(&pump, rad_s(rpm)).unwrap();
        let more = |valve_resistance_kpa_s_ml| {
            let model = RollerCentric { valve_resistance_kpa_s_ml, ..RollerCentric::PUBLISHED };
            let flow_ml_s = model.steady_state(&pump, rad_s(rpm)).unwrap().mean_flow_ml_s;
            100.0 * (flow_ml_s * TURN_RAD / rad_s(rpm) / law_ml - 1.0)
        };
        let found = more(RollerCentric::PUBLISHED.valve_resistance_kpa_s_ml);
        assert!((found - percent).abs() < 0.1, "{rollers} at {rpm} r/min: {found} %");
        assert!((0.0..0.8 * found).contains(&more(1e-5)), "{rollers} at {rpm} r/min: {} %", more(1e-5));
    }
}

#[test]
fn segments_come_and_go_as_rollers_touch_and_leave() {
    for (rollers, least, most) in [(2, 4, 5), (3, 5, 6), (8, 10, 11)] {
        let pump = preset(rollers);
        for rpm in [60.0, -60.0] {
            let mut run =
                RollerRun::new(&pump, RollerCentric::PUBLISHED, at_rpm(rpm), DEFAULT_TOLERANCE).unwrap();
            let states = (1..2000).map(|n| {
                run.run_to(1e-3 * f64::from(n)).unwrap();
                // The state has two pressures and two flows of the lines.
                4 + run.segments_kpa().count()
            });
            let (fewest, largest) =
                states.fold((usize::MAX, 0), |(low, high), states| (low.min(states), high.max(states)));
            assert_eq!((fewest, largest), (least, most), "{rollers} rollers at {rpm} r/min");
        }
    }
}

#[test]
fn pressures_of_segments_stay_bounded() {
    for (rollers, rpm) in [(2, 100.0), (2, 300.0), (3, 10.0), (3, 100.0), (3, 170.0)] {
        let pump = preset(rollers);
        let mut run =
            RollerRun::new(&pump, RollerCentric::PUBLISHED, at_rpm(rpm), DEFAULT_TOLERANCE).unwrap();
        for n in 1..=5000 {
            run.run_to(20.0 * 60.0 / rpm * f64::from(n) / 5000.0).unwrap();
            for kpa in run.segments_kpa() {
                assert!((50.0..140.0).contains(&kpa), "{rollers} rollers at {rpm} r/min: {kpa} kPa");
            }
        }
    }
}

#[test]
fn in_reverse_inlet_and_outlet_swap_roles() {
    let (measured, wide) = (preset(3), Line { compliance_ml_kpa: 0.06, ..Line::PUBLISHED });
    let of =
        |inlet, outlet| Pump::new(*measured.geometry(), *measured.roller_volume(), inlet, outlet).unwrap();
    let (pump, mirrored) = (of(Line::PUBLISHED, wide), of(wide, Line::PUBLISHED));
    let sealed_rad = core::f64::consts::PI + 2.0 * pump.geometry().contact_angle_rad;
    let forward = there_and_back();
    let backward = forward.map(|leg| Leg {
        angle_rad: -sealed_rad - leg.angle_rad,
        speed_rad_s: -leg.speed_rad_s,
        acceleration_rad_s2: -leg.acceleration_rad_s2,
        ..leg
    });
    let mut run = RollerRun::new(&pump, RollerCentric::PUBLISHED, forward, 1e-9).unwrap();
    let mut reverse = RollerRun::new(&mirrored, RollerCentric::PUBLISHED, backward, 1e-9).unwrap();
    for n in 0..=150 {
        let (there, back) = (run.at(0.01 * f64::from(n)).unwrap(), reverse.at(0.01 * f64::from(n)).unwrap());
        assert!((there.inlet_kpa - back.outlet_kpa).abs() < 1e-6, "{n}: {there:?} {back:?}");
        assert!((there.outlet_kpa - back.inlet_kpa).abs() < 1e-6, "{n}: {there:?} {back:?}");
        assert!((there.taken_ml + back.delivered_ml).abs() < 1e-8, "{n}: {there:?} {back:?}");
        assert!((there.delivered_ml + back.taken_ml).abs() < 1e-8, "{n}: {there:?} {back:?}");
    }
}

#[test]
fn tighter_tolerances_come_nearer() {
    let pump = preset(3);
    let at = |tolerance| {
        let mut run = RollerRun::new(&pump, RollerCentric::PUBLISHED, at_rpm(100.0), tolerance).unwrap();
        core::array::from_fn::<_, 400, _>(|n| {
            let sample = run.at(5e-3 * n as f64).unwrap();
            [sample.inlet_kpa, sample.outlet_kpa]
        })
    };
    let best = at(1e-11);
    let off = |tolerance| {
        let pairs = at(tolerance).into_iter().flatten().zip(best.into_iter().flatten());
        pairs.fold(0.0_f64, |largest, (found, best)| largest.max((found - best).abs()))
    };
    let (default, tight) = (off(DEFAULT_TOLERANCE), off(1e-8));
    assert!(default < 1e-3, "{default} kPa at the default tolerance");
    assert!(tight < 0.05 * default, "{tight} kPa at 1e-8, {default} at the default tolerance");
}

#[test]
fn a_rotor_that_stands_lets_the_lines_come_to_rest() {
    let pump = preset(3);
    let mut run =
        RollerRun::new(&pump, RollerCentric::PUBLISHED, there_and_back(), DEFAULT_TOLERANCE).unwrap();
    let late = run.at(10.0).unwrap();
    assert!((late.inlet_kpa - Line::PUBLISHED.reservoir_kpa).abs() < 1e-3, "{late:?}");
    assert!((late.outlet_kpa - Line::PUBLISHED.reservoir_kpa).abs() < 1e-3, "{late:?}");
    assert!(run.at(1e6).is_ok());
    let mut still = RollerRun::new(&pump, RollerCentric::PUBLISHED, [], DEFAULT_TOLERANCE).unwrap();
    assert_eq!(still.at(1.0).unwrap().delivered_ml, 0.0);
}

#[test]
fn what_cannot_be_modelled_is_refused_with_its_value() {
    let pump = preset(3);
    let refusal = |pump: &Pump, model: RollerCentric, tolerance| {
        RollerRun::new(pump, model, at_rpm(60.0), tolerance).map(|_| ()).unwrap_err().to_string()
    };
    let of = |change: fn(&mut RollerCentric)| {
        let mut model = RollerCentric::PUBLISHED;
        change(&mut model);
        refusal(&pump, model, DEFAULT_TOLERANCE)
    };
    assert!(of(|model| model.scale = 0.1).contains("scale of the segments is 0.1"));
    assert!(of(|model| model.distensibility_per_kpa = 0.0).contains("distensibility in 1/kPa is 0"));
    assert!(of(|model| model.valve_resistance_kpa_s_ml = f64::NAN).contains("resistance of an open roller"));
    assert!(of(|model| model.closure_rad = 0.9).contains("closure angle in rad is 0.9"));
    assert!(of(|model| model.ambient_kpa = -1.0).contains("ambient pressure in kPa absolute is -1"));
    assert!(refusal(&pump, RollerCentric::PUBLISHED, 1.0).contains("integration tolerance"));
    let shifted = pump.shifted(0.1).unwrap();
    assert!(refusal(&shifted, RollerCentric::PUBLISHED, DEFAULT_TOLERANCE).contains("shift of the zero"));
    assert!(matches!(
        RollerCentric::PUBLISHED.steady_state(&pump, 0.0),
        Err(ModelError::OutOfRange { parameter: Parameter::Speed, .. })
    ));
}

#[test]
fn a_calibrated_pump_displaces_in_proportion() {
    let pump = preset(3);
    let flow = |pump: &Pump| {
        RollerCentric::of(pump, 85.7).unwrap().steady_state(pump, rad_s(20.0)).unwrap().mean_flow_ml_s
    };
    let scaled = pump.scaled(1.02).unwrap();
    assert!((flow(&scaled) / flow(&pump) - 1.02).abs() < 1e-3, "{}", flow(&scaled) / flow(&pump));
}
