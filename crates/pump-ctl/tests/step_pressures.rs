//! The bound on what the motor's steps add to the predicted pressures, against runs that make every step.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use pump_ctl::plan::{Cruise, Doser, Limits, Motor, Phase, Plan, Ramps, Request};
use pump_model::units::rad_s;
use pump_model::{ExactRun, Leg, Line, Port, Pump};

/// Largest distance of the pressure of a line into which every step pushes its volume at once from that of the
/// smooth motion, kPa. The line swings freely between two steps: p'' + (R/L) p' + p/(L C) = 0 in closed form.
fn largest_distance_kpa(plan: &Plan, pump: &Pump) -> f64 {
    let line = *pump.outlet();
    let decay = 0.5 * line.resistance_kpa_s_ml / line.inertance_kpa_s2_ml;
    let natural = 1.0 / (line.inertance_kpa_s2_ml * line.compliance_ml_kpa).sqrt();
    let swing = (natural * natural - decay * decay).sqrt();
    // The state is the pressure above the reservoir and its slope, p' = -q/C.
    let free = |[p, v]: [f64; 2], t: f64| {
        let (sine, cosine) = (swing * t).sin_cos();
        let fall = (-decay * t).exp();
        let one = (v + decay * p) / swing;
        let value = fall * (p * cosine + one * sine);
        let slope = fall * (-decay * (p * cosine + one * sine) + swing * (one * cosine - p * sine));
        [value, slope]
    };
    let mut smooth = ExactRun::from_rest(pump, Port::Outlet, plan.legs());
    let curve = pump.outlet_curve();
    let (mut state, mut at_s, mut volume_ml) = ([0.0; 2], 0.0, curve.volume_ml(plan.start().angle_rad()));
    let mut largest_kpa = 0.0_f64;
    for step in plan.each_step() {
        for look in 1..=16 {
            let t = at_s + (step.time_s - at_s) * f64::from(look) / 16.0;
            let there = smooth.at(t).above_reservoir_kpa;
            largest_kpa = largest_kpa.max((free(state, t - at_s)[0] - there).abs());
        }
        state = free(state, step.time_s - at_s);
        let after_ml = curve.volume_ml(step.angle_rad);
        state[0] += (after_ml - volume_ml) / line.compliance_ml_kpa;
        (at_s, volume_ml) = (step.time_s, after_ml);
        largest_kpa = largest_kpa.max((state[0] - smooth.at(at_s).above_reservoir_kpa).abs());
    }
    largest_kpa
}

/// Returns the pump with another outlet line.
fn with_outlet(pump: &Pump, line: Line) -> Pump {
    Pump::new(*pump.geometry(), *pump.roller_volume(), *pump.inlet(), line).unwrap()
}

fn plan(pump: &Pump, steps_per_rev: f64, rpm: f64, smooth: bool) -> Plan {
    let motor = Motor::new(steps_per_rev, 17.8, 500.0);
    let request = Request::new(21.0, Cruise::Speed { rad_s: rad_s(rpm) })
        .with_smooth(smooth)
        .with_ramps(Ramps::Fastest);
    Doser::new(pump, Limits::new(motor)).unwrap().plan(Phase::known(0.9), &request).unwrap()
}

#[test]
fn what_the_steps_add_stays_below_its_bound_at_every_speed_and_reaches_it_at_resonance() {
    let (mut closest, mut over_single) = (0.0_f64, 0.0_f64);
    for (resistance, steps_per_rev) in
        [(0.1108, 200.0), (0.1108, 400.0), (0.1108, 3200.0), (0.02, 200.0), (0.5, 200.0)]
    {
        let line = Line { resistance_kpa_s_ml: resistance, ..Line::PUBLISHED };
        let pump = with_outlet(&Pump::three_roller(), line);
        // A step each swing is 12.75 steps a second. The speeds pass it, its parts and its multiples.
        let swing_rpm = 12.75 * 60.0 / steps_per_rev;
        for part in [
            0.2, 0.25, 0.33, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 1.0, 1.05, 1.1, 1.3, 1.6, 2.0, 3.0, 6.0,
            20.0,
        ] {
            let rpm = part * swing_rpm;
            if rpm > 165.0 {
                continue;
            }
            for smooth in [false, true] {
                let plan = plan(&pump, steps_per_rev, rpm, smooth);
                let bound_kpa = plan.predict(&pump).unwrap().step_kpa;
                let found_kpa = largest_distance_kpa(&plan, &pump);
                assert!(
                    found_kpa <= bound_kpa,
                    "{resistance} {steps_per_rev} {rpm} {smooth}: {found_kpa} of {bound_kpa}"
                );
                closest = closest.max(found_kpa / bound_kpa);
                let single_kpa = 4.3982297 * plan.step_rad() / line.compliance_ml_kpa;
                over_single = over_single.max(found_kpa / single_kpa);
            }
        }
    }
    // Steps that come once a swing add up: a single step is no bound. The bound is near what they reach.
    assert!(over_single > 1.38, "{over_single}");
    assert!(closest > 0.9, "{closest}");
}

#[test]
fn fine_steps_add_no_more_than_one_of_them() {
    // A step of 12,800 a revolution is 0.0021590 mL, and that over 0.0361 mL/kPa is 0.059806 kPa.
    let pump = Pump::three_roller();
    let bound_kpa = plan(&pump, 12_800.0, 60.0, false).predict(&pump).unwrap().step_kpa;
    assert!((1.0..1.1).contains(&(bound_kpa / 0.059_806)), "{bound_kpa}");
    // Nothing damps this line, and the bound is finite.
    let line = Line { resistance_kpa_s_ml: 0.0, ..Line::PUBLISHED };
    let undamped = with_outlet(&pump, line);
    let plan = plan(&undamped, 12_800.0, 60.0, false);
    assert!(plan.predict(&undamped).map_or(true, |found| found.step_kpa.is_finite()));
    let legs = [Leg::constant_speed(0.0, 1.0)];
    assert!(undamped.outflow_ripple(legs).is_none());
}
