//! Claims about the volume that a line takes back from the vessel.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use pump_ctl::plan::{Cruise, Doser, Limits, Motor, Phase, Plan, Ramps, Request};
use pump_ctl::step::Direction;
use pump_model::{ExactRun, Port, Pump, VesselRun};

const MOTOR: Motor = Motor::new(12_800.0, 17.8, 500.0);

fn dose(pump: &Pump, start: Phase, volume_ml: f64, rate_ml_s: f64) -> Plan {
    let request = Request::new(volume_ml, Cruise::Flow { ml_s: rate_ml_s }).with_ramps(Ramps::Fastest);
    Doser::new(pump, Limits::new(MOTOR)).unwrap().plan(start, &request).unwrap()
}

#[test]
fn a_long_dose_has_the_back_flow_of_its_whole_motion() {
    let pump = Pump::three_roller();
    // At 50 mL/s the line takes back a part of every pulse.
    for (volume_ml, rate_ml_s) in [(700.0, 50.0), (-400.0, 50.0), (300.0, 5.0), (2.0, 5.0)] {
        let plan = dose(&pump, Phase::known(0.3), volume_ml, rate_ml_s);
        let told = plan.back_flow(&pump).unwrap();
        let run = ExactRun::from_rest(&pump, Port::Outlet, plan.legs());
        let is_forward = plan.direction() == Direction::Forward;
        let whole = VesselRun::new(run, is_forward).back_flow_to_rest(plan.profile().duration_s()).unwrap();
        let case = format!("{volume_ml} mL at {rate_ml_s} mL/s: {told:?} {whole:?}");
        assert!((told.backflow_ml - whole.backflow_ml).abs() < 1e-8, "{case}");
        let tolerance = 1e-8 * whole.reverse_flow_ml.max(1.0);
        assert!((told.reverse_flow_ml - whole.reverse_flow_ml).abs() < tolerance, "{case}");
        assert!(rate_ml_s < 50.0 || told.reverse_flow_ml > 10.0 * told.backflow_ml, "{case}");
    }
}

#[test]
fn an_unknown_angle_has_the_largest_back_flow_of_all() {
    let pump = Pump::three_roller();
    let unknown = dose(&pump, Phase::unknown(pump.pitch_rad()), 5.0, 5.0);
    let told = unknown.back_flow(&pump).unwrap();
    let steps = unknown.steps();
    let turn_ml = |start: f64| {
        let curve = pump.outlet_curve();
        curve.volume_ml(start + steps as f64 * unknown.step_rad()) - curve.volume_ml(start)
    };
    let mut largest: f64 = 0.0;
    for n in 0..64 {
        let start = pump.pitch_rad() * f64::from(n) / 64.0;
        let known = dose(&pump, Phase::known(start), turn_ml(start), 5.0);
        largest = largest.max(known.back_flow(&pump).unwrap().backflow_ml);
    }
    // The looks are a sixteenth of a pitch apart, so the largest may lie between two of them.
    assert!((0.94..1.001).contains(&(told.backflow_ml / largest)), "{told:?} {largest}");
}
