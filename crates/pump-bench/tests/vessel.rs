//! The volume in the vessel against the closed form that the planner inverts.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};
use pump_bench::built_in;
use pump_bench::drives::Sim;
use pump_ctl::plan::{Cruise, Doser, Limits, Phase, Plan, Ramps, Request};
use pump_model::circuit::{Circuit, Linear, Lumped, NoFlow, options};
use pump_model::integrator::Rodas5p;
use pump_model::{Line, Port, PortRun, Pump, RollerVolume};

/// After the last step, s: 1e-6 of the swing is left in the published line.
const WAIT_S: f64 = 1.2;
const TOLERANCE: f64 = 1e-9;

/// A random dose of 0.5 to 500 mL in either direction, from any angle, on either pump, at up to its fastest speed.
fn any_plan() -> impl Strategy<Value = (Pump, Plan)> {
    (any::<bool>(), 0.5..500.0_f64, any::<bool>(), 0.0..std::f64::consts::TAU, 0.02..1.0_f64).prop_map(
        |(three, volume, reverse, start, speed)| {
            let file = built_in(if three { "three-roller" } else { "two-roller" }).unwrap();
            let (pump, limits) = (file.model().unwrap(), Limits::new(file.limits().motor));
            let cruise = Cruise::Speed { rad_s: speed * limits.motor.max_speed_rad_s };
            let request = Request::new(if reverse { -volume } else { volume }, cruise);
            let plan = Doser::new(&pump, limits).unwrap().plan(Phase::known(start), &request).unwrap();
            (pump, plan)
        },
    )
}

fn check(cases: u32, received_ml: impl Fn(&Pump, &Plan) -> f64) {
    let mut runner = TestRunner::new(Config { cases, max_shrink_iters: 0, ..Config::default() });
    runner
        .run(&any_plan(), |(pump, plan)| {
            let received_ml = received_ml(&pump, &plan);
            // The volume left in the line 1.2 s later is part of the closed form: -C (P - P_res).
            prop_assert!(
                (received_ml - plan.planned_ml()).abs() < 1e-6,
                "received {received_ml}, planned {}",
                plan.planned_ml()
            );
            Ok(())
        })
        .unwrap();
}

#[test]
fn the_vessel_receives_the_planned_volume_from_the_motion_curve() {
    check(200, |pump, plan| {
        let mut outlet = PortRun::<_, 3>::from_rest(pump, Port::Outlet, plan.legs(), TOLERANCE).unwrap();
        outlet.run_to(plan.profile().duration_s() + WAIT_S).unwrap();
        outlet.passed_ml()
    });
}

#[test]
fn the_vessel_receives_the_planned_volume_from_the_staircase_of_steps() {
    check(20, |pump, plan| {
        let mut sim = Sim::new(pump);
        sim.make(plan);
        sim.wait(WAIT_S);
        sim.received_ml()
    });
}

/// A dose of 0.5 mL on the three-roller pump with this outlet line.
fn short_dose(outlet: Line) -> (Pump, Plan) {
    let file = built_in("three-roller").unwrap();
    let (model, limits) = (file.model().unwrap(), Limits::new(file.limits().motor));
    let pump =
        Pump::new(*model.geometry(), RollerVolume::measured().unwrap(), *model.inlet(), outlet).unwrap();
    let request = Request::new(0.5, Cruise::Flow { ml_s: 5.0 }).with_ramps(Ramps::Fastest);
    (pump, Doser::new(&pump, limits).unwrap().plan(Phase::known(1.0), &request).unwrap())
}

/// The integrator knows nothing of the exact solution, and the volume in the vessel is a state of its own there.
#[test]
fn the_staircases_vessel_and_pressure_are_those_of_the_integrator() {
    let published = Line::PUBLISHED;
    for line in [
        published,
        // It creeps.
        Line { resistance_kpa_s_ml: 5.0, ..published },
        // It never rests.
        Line { resistance_kpa_s_ml: 0.0, ..published },
        // It swings many times between two steps.
        Line { compliance_ml_kpa: 1e-4, inertance_kpa_s2_ml: 1e-4, ..published },
    ] {
        let (pump, plan) = short_dose(line);
        let mut sim = Sim::new(&pump);
        let model = Lumped::new(&line, Linear::of(&line), Port::Outlet);
        let circuit = Circuit::new(model, Port::Outlet, NoFlow);
        let mut integrator = Rodas5p::new(0.0, [0.0; 3], options(&model, TOLERANCE, 1.0)).unwrap();
        let until = |integrator: &mut Rodas5p<3>, time_s| {
            while integrator.time_s() < time_s {
                integrator.step(&circuit, time_s).unwrap();
            }
        };
        let mut last_ml = pump.outlet_curve().volume_ml(1.0);
        for step in plan.each_step() {
            until(&mut integrator, step.time_s);
            let (volume_ml, mut state) = (pump.outlet_curve().volume_ml(step.angle_rad), integrator.state());
            state[0] += (volume_ml - last_ml) / line.compliance_ml_kpa;
            integrator.set_state(state);
            integrator.restart();
            last_ml = volume_ml;
        }
        sim.make(&plan);
        for _ in 0..5 {
            let [above_kpa, _, received_ml] = integrator.state();
            let found_kpa = sim.outlet_kpa() - line.reservoir_kpa;
            assert!(
                (found_kpa - above_kpa).abs() < 1e-5 * (1.0 + above_kpa.abs()),
                "{found_kpa} for {above_kpa}"
            );
            let found_ml = sim.received_ml();
            assert!((found_ml - received_ml).abs() < 1e-6, "{found_ml} for {received_ml}");
            let time_s = integrator.time_s() + 0.007;
            until(&mut integrator, time_s);
            sim.wait(0.007);
        }
    }
}

/// Each step is an impulse, whose response is known in closed form.
#[test]
fn the_staircases_pressure_is_the_sum_of_the_responses_to_its_steps() {
    let (pump, plan) = short_dose(Line::PUBLISHED);
    let mut sim = Sim::new(&pump);
    sim.make(&plan);
    sim.wait(0.01);

    // p(t) after an impulse dV into C of a line at rest: dV/C e^(-d t/2) (cos v t + d/(2 v) sin v t), d = R/L.
    let line = pump.outlet();
    let d = line.resistance_kpa_s_ml / line.inertance_kpa_s2_ml;
    let v = (line.natural_rad_s().powi(2) - 0.25 * d * d).sqrt();
    let end_s = plan.profile().duration_s() + 0.01;
    let mut last_ml = pump.outlet_curve().volume_ml(1.0);
    let sum_kpa: f64 = plan
        .each_step()
        .map(|step| {
            let (volume_ml, t) = (pump.outlet_curve().volume_ml(step.angle_rad), end_s - step.time_s);
            let response = (-0.5 * d * t).exp() * ((v * t).cos() + 0.5 * d / v * (v * t).sin());
            let pushed_ml = volume_ml - last_ml;
            last_ml = volume_ml;
            pushed_ml / line.compliance_ml_kpa * response
        })
        .sum();
    let found_kpa = sim.outlet_kpa() - line.reservoir_kpa;
    assert!((found_kpa - sum_kpa).abs() < 1e-6, "{found_kpa} for {sum_kpa}");
    assert!(sum_kpa.abs() > 0.1, "the check is worth something");
}
