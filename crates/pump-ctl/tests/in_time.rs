//! Claims about doses within a time, with line-aware ramps.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::f64::consts::TAU;

use pump_ctl::plan::{
    Cruise, Doser, Limits, Motor, Phase, Plan, PlanError, PressureLimits, Ramps, Request, Retarget,
};
use pump_model::{Line, Pump};

const MOTOR: Motor = Motor::new(12_800.0, 17.8, 500.0);

/// Part of a cruise speed at which a dose must miss its time.
const SLOWER: f64 = 0.99;

/// Returns the time of motion and settling, s.
fn total_s(pump: &Pump, plan: &Plan) -> f64 {
    plan.profile().duration_s() + plan.predict(pump).unwrap().settle_s
}

fn within(request: &Request, time_s: f64) -> Request {
    request.with_cruise(Cruise::Within { time_s })
}

/// A pump whose lines swing more slowly and more than the paper's.
fn pump_with_slow_lines() -> Pump {
    let paper = Pump::three_roller();
    let line = Line { compliance_ml_kpa: 0.2, inertance_kpa_s2_ml: 0.02, ..Line::PUBLISHED };
    Pump::new(*paper.geometry(), *paper.roller_volume(), line, line).unwrap()
}

/// Doses that were planned, those of them that end within 1 % of their time, and those that are hurried.
#[derive(Debug, Default)]
struct Seen {
    planned: u32,
    used_up: u32,
    hurried: u32,
    refused: u32,
}

/// Plans random doses within random times near the shortest and beyond, and checks each.
fn check_random(pump: &Pump, limits: Limits, smooth: bool, count: u32) -> Seen {
    let doser = Doser::new(pump, limits).unwrap();
    let mut seen = Seen::default();
    for n in 1..=count {
        // Multiples of these numbers fill the cube evenly (Roberts, "The unreasonable effectiveness of quasirandom
        // sequences", 2018).
        let part = |base: f64| (f64::from(n) * base).fract();
        let sign = if n % 3 == 0 { -1.0 } else { 1.0 };
        let volume_ml = sign * 0.02 * 1500_f64.powf(part(0.819_172_513));
        let start = Phase::known(TAU * part(0.671_043_607));
        let request = Request::new(volume_ml, Cruise::Fastest).with_smooth(smooth);
        let soon_s = total_s(pump, &doser.plan(start, &request).unwrap());
        let time_s = soon_s * (0.7 + 2.5 * part(0.549_700_478) * part(0.549_700_478));
        let dose = format!("{volume_ml} mL in {time_s} s, smooth {smooth}");
        let request = within(&request, time_s);
        match doser.plan(start, &request) {
            Ok(plan) => {
                let took_s = total_s(pump, &plan);
                assert!(took_s <= time_s, "{dose}: {took_s}");
                let margins = limits.margins(pump, &plan);
                let used = [margins.inlet, margins.outlet].into_iter().flatten().map(|margin| margin.used);
                assert!(used.clone().all(|used| used <= 1.0), "{dose}: {margins:?}");
                let steepest = plan.legs().map(|leg| leg.acceleration_rad_s2.abs()).fold(0.0, f64::max);
                assert!(
                    steepest <= 500.0 * (1.0 + 1e-9) && plan.profile().peak_rad_s() <= 17.8 * (1.0 + 1e-9)
                );
                if !plan.is_hurried() {
                    let rad_s = SLOWER * plan.profile().cruise_rad_s();
                    let slower = doser.plan(start, &request.with_cruise(Cruise::Speed { rad_s }));
                    let slower_s = slower.map_or(f64::INFINITY, |slower| total_s(pump, &slower));
                    assert!(slower_s > time_s, "{dose}: 1 % slower it takes {slower_s}");
                }
                seen.planned += 1;
                seen.used_up += u32::from(took_s >= 0.99 * time_s);
                seen.hurried += u32::from(plan.is_hurried());
            }
            Err(PlanError::TimeTooShort { fastest_s, .. }) => {
                assert!(fastest_s > time_s, "{dose}: {fastest_s}");
                assert!(doser.plan(start, &within(&request, fastest_s)).is_ok(), "{dose}: {fastest_s}");
                let fastest = doser.plan(start, &request.with_ramps(Ramps::Fastest));
                assert!(fastest.is_err(), "{dose}: the fastest ramps meet it");
                seen.refused += 1;
            }
            Err(other) => panic!("{dose}: {other}"),
        }
    }
    seen
}

#[test]
fn a_time_is_met_by_the_slowest_cruise_with_ramps_of_its_own() {
    let limits = Limits::new(MOTOR);
    for pump in [Pump::three_roller(), Pump::two_roller(), pump_with_slow_lines()] {
        let seen = check_random(&pump, limits, false, 40);
        assert!(seen.planned >= 30 && seen.hurried <= 16, "{seen:?}");
        // The others end sooner by a part of a swing: a slower cruise would need one more to settle.
        assert!(seen.used_up * 10 >= seen.planned * 6, "{seen:?}");
    }
}

#[test]
fn a_time_is_met_within_pressure_limits() {
    let pressures = PressureLimits { max_outlet_kpa: Some(110.0), min_inlet_kpa: Some(65.0) };
    let seen = check_random(&Pump::three_roller(), Limits::new(MOTOR).with_pressures(pressures), false, 20);
    assert!(seen.planned >= 12, "{seen:?}");
}

#[test]
fn a_smooth_dose_meets_its_time_with_the_slowest_cruise() {
    let seen = check_random(&Pump::three_roller(), Limits::new(MOTOR), true, 10);
    assert!(seen.planned >= 7, "{seen:?}");
}

#[test]
fn a_long_dose_uses_the_time_that_it_has() {
    let pump = Pump::three_roller();
    let doser = Doser::new(&pump, Limits::new(MOTOR)).unwrap();
    for start in [0.0, 0.4, 0.9, 1.3, 1.8] {
        for (volume_ml, time_s) in [(25.0, 2.0), (25.0, 4.0), (25.0, 30.0), (100.0, 20.0), (-10.0, 3.0)] {
            let plan = doser
                .plan(Phase::known(start), &within(&Request::new(volume_ml, Cruise::Fastest), time_s))
                .unwrap();
            let took_s = total_s(&pump, &plan);
            // Settling goes by parts of the line's swing, 0.04 s each, so a slower cruise may miss a short time.
            let least_s = 0.99 * time_s - 0.02;
            assert!(
                took_s <= time_s && took_s > least_s,
                "{volume_ml} mL, {start}: {took_s} of {time_s}"
            );
            assert!(!plan.is_hurried());
        }
    }
}

#[test]
fn a_time_near_the_shortest_has_the_ramps_that_take_back_least() {
    let pump = Pump::three_roller();
    let doser = Doser::new(&pump, Limits::new(MOTOR)).unwrap();
    let start = Phase::known(0.4);
    let request = Request::new(3.0, Cruise::Fastest);
    let back_ul = |plan: &Plan| 1e3 * plan.back_flow(&pump).unwrap().backflow_ml;
    let gentle_s = total_s(&pump, &doser.plan(start, &request).unwrap());
    let Err(PlanError::TimeTooShort { fastest_s, .. }) = doser.plan(start, &within(&request, 1e-3)) else {
        panic!("no dose takes a millisecond")
    };
    assert!(fastest_s < gentle_s, "{fastest_s} {gentle_s}");
    let hurried = doser.plan(start, &within(&request, 1.01 * fastest_s)).unwrap();
    assert!(hurried.is_hurried() && total_s(&pump, &hurried) <= 1.01 * fastest_s);
    // The motor's own ramps would leave the line in full swing.
    let plain = doser.plan(start, &request.with_ramps(Ramps::Fastest)).unwrap();
    assert!(back_ul(&hurried) < 0.5 * back_ul(&plain), "{} {}", back_ul(&hurried), back_ul(&plain));
    let relaxed = doser.plan(start, &within(&request, 2.0 * gentle_s)).unwrap();
    assert!(!relaxed.is_hurried() && back_ul(&relaxed) < 3.0, "{}", back_ul(&relaxed));
}

#[test]
fn an_angle_that_is_not_stated_meets_every_time_that_the_fastest_ramps_meet() {
    let pump = Pump::three_roller();
    let doser = Doser::new(&pump, Limits::new(MOTOR)).unwrap();
    for start in [Phase::within(0.4, 0.3), Phase::unknown(pump.pitch_rad())] {
        let request = Request::new(8.0, Cruise::Fastest);
        let shortest_s = |ramps| match doser.plan(start, &within(&request, 1e-3).with_ramps(ramps)) {
            Err(PlanError::TimeTooShort { fastest_s, .. }) => fastest_s,
            other => panic!("{other:?}"),
        };
        let [aware_s, fastest_s] = [Ramps::LineAware, Ramps::Fastest].map(shortest_s);
        assert!(aware_s <= fastest_s, "{aware_s} {fastest_s}");
        let plan = doser.plan(start, &within(&request, aware_s)).unwrap();
        assert!(total_s(&pump, &plan) <= aware_s);
        let plan = doser.plan(start, &within(&request, 4.0)).unwrap();
        assert!(!plan.is_hurried() && total_s(&pump, &plan) > 0.99 * 4.0);
    }
}

#[test]
fn a_change_in_mid_dose_meets_its_time() {
    let pump = Pump::three_roller();
    let doser = Doser::new(&pump, Limits::new(MOTOR)).unwrap();
    let whole = doser.plan(Phase::known(0.3), &Request::new(25.0, Cruise::Flow { ml_s: 5.0 })).unwrap();
    for time_s in [1.0, 2.5, 6.0] {
        let rest = doser.retarget(&whole, &Retarget::new(6000, 20.0, Cruise::Within { time_s })).unwrap();
        let took_s = total_s(&pump, &rest);
        assert!(took_s <= time_s && took_s > 0.98 * time_s, "{took_s} of {time_s}");
    }
}
