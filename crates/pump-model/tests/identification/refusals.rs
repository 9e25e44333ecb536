//! Claims that measurements that say too little, or nothing, are refused by name.

use pump_model::identification::{
    ComplianceFit, FlowPoint, IdentificationError, InjectionPoint, LineFit, PressureSample, Recording,
    ResistanceFit, RotorMotion, Sought, SoughtParameter,
};
use pump_model::{Leg, Line, Port, Pump};

use crate::dice::Dice;

fn said<T: core::fmt::Debug>(result: Result<T, IdentificationError>, part: &str) {
    let error = result.unwrap_err().to_string();
    assert!(error.contains(part), "{part}: {error}");
}

#[test]
fn points_that_determine_nothing_are_refused() {
    let point = |flow_ml_s, drop_kpa| FlowPoint { flow_ml_s, drop_kpa, standard_kpa: 1.0 };
    let of = |points: &[FlowPoint]| ResistanceFit::of(points, false);
    said(of(&[]), "0 points of flow and pressure; 2 at least");
    said(of(&[point(1.0, 1.0)]), "1 points of flow and pressure; 2 at least");
    said(of(&[point(0.0, 1.0), point(0.0, 1.0)]), "at one flow");
    said(ResistanceFit::of(&[point(5.0, 1.0), point(5.0, 1.1), point(5.0, 1.0)], true), "at one flow");
    said(of(&[point(1.0, -1.0), point(2.0, -2.0)]), "does not rise with the flow");
    said(of(&[5.0, 6.0, 7.0, 8.0].map(|flow_ml_s| point(flow_ml_s, 9.0))), "as large at every flow");
    let level = [point(1.0, 0.1), point(2.0, 0.1), point(3.0, 0.1)];
    said(ResistanceFit::of(&level, true), "does not rise with the flow");
    said(of(&[point(1.0, 3.0), point(1.0, -2.0), point(1.0, 0.1)]), "twice its standard error exceeds it");
    said(of(&[point(1.0, 1.0), point(f64::NAN, 1.0)]), "flow in mL/s of point 2 is NaN");
    let weightless = FlowPoint { standard_kpa: 0.0, ..point(1.0, 1.0) };
    said(of(&[weightless, weightless]), "standard uncertainty of the pressure in kPa of point 1 is 0");

    let point = |volume_ml, pressure_kpa| InjectionPoint { volume_ml, pressure_kpa };
    said(ComplianceFit::of(&[point(0.0, 88.0), point(1.0, 90.0)]), "3 at least");
    said(ComplianceFit::of(&[point(1.0, 88.0), point(1.0, 90.0), point(1.0, 89.0)]), "at one volume");
    said(ComplianceFit::of(&[point(0.0, 88.0), point(1.0, 80.0), point(2.0, 71.0)]), "does not rise");
    let level = [point(0.0, 88.1), point(1.0, 88.1), point(2.0, 88.1)];
    said(ComplianceFit::of(&level), "does not rise");
    said(
        ComplianceFit::of(&[point(0.0, 88.0), point(1.0, f64::INFINITY), point(2.0, 90.0)]),
        "point 2 is inf",
    );
}

#[test]
fn records_that_determine_nothing_are_refused() {
    let pump = Pump::three_roller();
    let legs = [Leg::constant_speed(0.0, 10.0)];
    let mut dice = Dice(4);
    let flat: Vec<_> = (0..200)
        .map(|n| PressureSample { time_s: f64::from(n) * 2e-3, pressure_kpa: 88.637 + 0.1 * dice.normal() })
        .collect();
    let recording = |samples, motion| Recording { port: Port::Outlet, samples, motion };
    let from_rest = RotorMotion::FromRest(&legs);
    let of = |samples: &[PressureSample], motion, sought| {
        LineFit::of(&pump, &Recording { port: Port::Outlet, samples, motion }, sought)
    };
    // A pump that turned leaves no flat line, so whatever is found is not its line.
    said(of(&flat, from_rest, Sought::LINE), "a constant pressure explains 0");
    let level: Vec<_> = flat.iter().map(|sample| PressureSample { pressure_kpa: 150.0, ..*sample }).collect();
    said(of(&level, from_rest, Sought::LINE.with_pressure(true)), "explains 0.0 %");
    said(
        of(&flat[..3], from_rest, Sought::LINE),
        "3 samples of pressure; 4 at least are needed for 3 parameters",
    );
    let none = Sought::LINE.with_resistance(false).with_compliance(false).with_inertance(false);
    assert!(of(&flat, from_rest, none).is_err());
    let steady = RotorMotion::Steady { angle_rad: 0.0, speed_rad_s: 10.0 };
    let both = Sought::LINE.with_angle(true).with_start(true);
    said(of(&flat, steady, both), "start angle and start time are the same in a steady state");
    said(of(&flat, RotorMotion::Steady { angle_rad: 0.0, speed_rad_s: 0.0 }, Sought::LINE), "speed in rad/s");
    said(of(&flat, RotorMotion::FromRest(&[]), Sought::LINE), "number of legs");
    let mut backwards = flat.clone();
    backwards[7].time_s = 0.0;
    said(of(&backwards, from_rest, Sought::LINE), "time in s of sample 8 is 0");
    backwards[3].pressure_kpa = f64::NAN;
    said(of(&backwards, from_rest, Sought::LINE), "pressure in kPa absolute of sample 4 is NaN");

    // The samples before the motor starts say nothing of the line.
    let late = [Leg { start_s: 10.0, ..legs[0] }];
    let mean = Sought::LINE.with_compliance(false).with_inertance(false);
    let error = LineFit::of(&pump, &recording(&flat, RotorMotion::FromRest(&late)), mean).unwrap_err();
    assert!(
        matches!(error, IdentificationError::Undetermined { parameter: SoughtParameter::Resistance, .. }),
        "{error}"
    );

    let frictionless = Line { resistance_kpa_s_ml: 0.0, ..Line::PUBLISHED };
    let pump = Pump::new(*pump.geometry(), *pump.roller_volume(), frictionless, frictionless).unwrap();
    let error = LineFit::of(&pump, &recording(&flat, from_rest), Sought::LINE).unwrap_err();
    assert!(error.to_string().contains("line resistance to start from in kPa s/mL is 0"), "{error}");
}

#[test]
fn a_sensor_that_drifts_is_no_noise() {
    let pump = Pump::three_roller();
    let legs = [Leg::constant_speed(0.0, 10.0)];
    let times: Vec<_> =
        (0..5000).map(|n| PressureSample { time_s: f64::from(n) * 1e-4, pressure_kpa: 0.0 }).collect();
    let recording = |samples| Recording { port: Port::Outlet, samples, motion: RotorMotion::FromRest(&legs) };
    let samples: Vec<_> = recording(&times)
        .predicted_kpa(&pump)
        .unwrap()
        .zip(&times)
        .map(|(kpa, sample)| PressureSample { pressure_kpa: kpa + 2.0 * sample.time_s, ..*sample })
        .collect();
    let only = Sought::LINE.with_resistance(false).with_compliance(false);
    said(LineFit::of(&pump, &recording(&samples), only), "stays alike for more than 1024 samples");
}
