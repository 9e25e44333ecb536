//! Claims about doses within a time.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::f64::consts::TAU;
use std::time::Instant;

use pump_ctl::plan::{Cruise, Doser, Limits, Motor, Phase, Plan, PlanError, Ramps, Request};
use pump_model::{Line, Pump};

const MOTOR: Motor = Motor::new(12_800.0, 17.8, 500.0);

fn total_s(pump: &Pump, plan: &Plan) -> f64 {
    plan.profile().duration_s() + plan.predict(pump).unwrap().settle_s
}

#[test]
fn explore() {
    let built_in = Pump::three_roller();
    let slow_line = Line { compliance_ml_kpa: 0.2, inertance_kpa_s2_ml: 0.02, ..Line::PUBLISHED };
    let other = Pump::new(*built_in.geometry(), *built_in.roller_volume(), slow_line, slow_line).unwrap();
    for (name, pump) in [("3", &built_in), ("2", &Pump::two_roller()), ("slow", &other)] {
        for smooth in [false, true] {
            for n in 1..=(if smooth { 15 } else { 40 }) {
                let part = |base: f64| (f64::from(n) * base).fract();
                let volume_ml = 0.02 * 1500f64.powf(part(0.754_877_666));
                let start = Phase::known(TAU * part(0.569_840_291));
                let limits = Limits::new(MOTOR);
                let doser = Doser::new(pump, limits).unwrap();
                let fastest = Request::new(volume_ml, Cruise::Fastest).with_smooth(smooth);
                let fastest = doser.plan(start, &fastest).unwrap();
                let time_s = total_s(pump, &fastest) * (0.7 + 2.5 * part(0.32471) * part(0.32471));
                let request = Request::new(volume_ml, Cruise::Within { time_s }).with_smooth(smooth);
                let began = Instant::now();
                let found = doser.plan(start, &request);
                let took_ms = began.elapsed().as_secs_f64() * 1e3;
                let began = Instant::now();
                let quick = doser.plan(start, &request.with_ramps(Ramps::Fastest));
                let quick_ms = began.elapsed().as_secs_f64() * 1e3;
                match found {
                    Ok(plan) => {
                        let used = total_s(pump, &plan) / time_s;
                        let v = plan.profile().cruise_rad_s();
                        let slower = request.with_cruise(Cruise::Speed { rad_s: 0.99 * v });
                        let slower = total_s(pump, &doser.plan(start, &slower).unwrap()) / time_s;
                        println!(
                            "{name} {smooth} {volume_ml:.3} mL in {time_s:.3}: used {used:.5}, 1 % slower {slower:.5} hurried {} back {:.2} uL v {v:.3} {took_ms:.1} ms (fastest {quick_ms:.1} ms {})",
                            plan.is_hurried(),
                            1e3 * plan.back_flow(pump).unwrap().backflow_ml,
                            quick.map_or(0.0, |plan| plan.profile().cruise_rad_s()),
                        );
                    }
                    Err(PlanError::TimeTooShort { fastest_s, .. }) => {
                        let again =
                            doser.plan(start, &request.with_cruise(Cruise::Within { time_s: fastest_s }));
                        println!(
                            "{name} {smooth} {volume_ml:.3} mL in {time_s:.3}: refused, {fastest_s} {} {took_ms:.1} ms; fastest ramps {:?} {quick_ms:.1} ms",
                            again.is_ok(),
                            quick.map(|plan| total_s(pump, &plan))
                        );
                    }
                    Err(other) => println!("{name} {smooth} {volume_ml} {time_s}: {other}"),
                }
            }
        }
    }
}
