//! The last dose, as a scale can weigh it: how far the rollers turned for what is in the vessel.

use pump_bench::DoseRequest;
use pump_bench::calibration::{CalibrationError, CalibrationRun, Earlier, Expected, Reading, Weighing};
use pump_bench::record::{LastDose, Purpose};
use pump_bench::units::stated_reading;
use pump_ctl::plan::Phase;

use crate::bench::{Lab, stop_at};

fn last(lab: &Lab) -> Option<LastDose> {
    lab.bench.stands().unwrap().last
}

/// Returns the model volume of the last dose from the outlet's curve, in mL.
fn turned_ml(lab: &Lab) -> f64 {
    let (dose, curve) = (last(lab).unwrap(), lab.bench.model().outlet_curve());
    curve.volume_ml(dose.start_angle_rad + dose.turned_rad) - curve.volume_ml(dose.start_angle_rad)
}

#[test]
fn a_dose_that_was_stopped_and_resumed_is_weighed_as_one() {
    let lab = Lab::new();
    lab.home(Some(Phase::known(0.3)));
    lab.stopped(DoseRequest::dose(9.0), 0.4);
    let mut session = lab.bench.session().unwrap();
    let rest = session.prepare_rest(DoseRequest::dose(0.0)).unwrap();
    stop_at(&mut session, &rest, 0.5);
    let rest = session.prepare_rest(DoseRequest::dose(0.0)).unwrap();
    session.run(&rest, |_| std::ops::ControlFlow::Continue(())).unwrap();
    drop(session);
    assert_eq!(last(&lab).unwrap().start_angle_rad, 0.3);
    assert!((turned_ml(&lab) - 9.0).abs() < 2e-3, "{}", turned_ml(&lab));
}

#[test]
fn a_retraction_counts_for_the_next_dose_that_repays_it() {
    let lab = Lab::new();
    let back = DoseRequest::dose(6.0).with_retraction(0.5);
    lab.dose(back);
    assert!((turned_ml(&lab) - 6.0).abs() < 2e-3);
    lab.dose(back);
    // The rollers turned for 6.5 mL, and 0.5 mL of these filled the tube again.
    assert!((turned_ml(&lab) - 6.0).abs() < 4e-3, "{}", turned_ml(&lab));
}

#[test]
fn what_nobody_can_weigh_is_no_last_dose() {
    let lab = Lab::new();
    let (file, pump) = (lab.bench.file(), lab.bench.model());
    let run = |lab: &Lab| CalibrationRun::of_last_dose(last(lab), file, pump, Reading::MassG(5.0));
    assert!(matches!(run(&lab), Err(CalibrationError::NoLastDose)));
    lab.dose(DoseRequest::dose(5.0));
    assert!(run(&lab).is_ok());
    lab.dose(DoseRequest::new(Purpose::Prime, 5.0));
    assert!(matches!(run(&lab), Err(CalibrationError::NoLastDose)));
    lab.dose(DoseRequest::dose(5.0));
    lab.home(Some(Phase::known(0.0)));
    assert!(matches!(run(&lab), Err(CalibrationError::NoLastDose)));
    lab.killed(DoseRequest::dose(5.0), 3);
    let error = run(&lab).unwrap_err();
    assert!(matches!(error, CalibrationError::UnsureLastDose { .. }), "{error}");
}

#[test]
fn from_an_unknown_angle_whole_pitches_are_weighed_and_doses_that_the_angle_leaves_sure() {
    let lab = Lab::new();
    let (file, pump) = (lab.bench.file(), lab.bench.model());
    let weighed = |volume_ml: f64| {
        lab.home(None);
        lab.dose(DoseRequest::dose(volume_ml));
        CalibrationRun::of_last_dose(last(&lab), file, pump, Reading::MassG(volume_ml))
    };
    let whole = weighed(2.0 * pump.revolution_ml()).unwrap();
    assert_eq!((whole.start_angle_deg, whole.start_half_width_deg), (None, None));
    // The angle leaves half a revolution and a little unsure by more than the model's 2 x 2.4 %.
    let refused = weighed(12.0).unwrap_err();
    assert!(matches!(refused, CalibrationError::LastDoseFromUnknownAngle { .. }), "{refused}");
    assert!(refused.to_string().contains("the model is certain to 4.8 %"), "{refused}");
    // Over many revolutions it hardly counts: the run bears the mean of all angles.
    let long = weighed(208.0).unwrap();
    assert!((long.start_half_width_deg.unwrap() - 60.0).abs() < 1e-9);
    let (measured_ml, model_ml) = long.volumes_ml(pump, &Weighing::of(file), 1).unwrap();
    let mean_ml = long.turned_deg / 360.0 * pump.revolution_ml();
    assert!((model_ml / mean_ml - 1.0).abs() < 1e-4 && measured_ml > 208.0, "{model_ml} {mean_ml}");
}

#[test]
fn the_angle_that_a_weighed_dose_began_at_is_unsure_in_every_one_and_no_mean_reduces_it() {
    let lab = Lab::new();
    let reading = stated_reading("208.00mL").unwrap();
    let expected = Expected::of_digits(lab.bench.file(), &reading);
    let unsure = |from: Option<Phase>| {
        lab.home(from);
        lab.dose(DoseRequest::dose(208.0));
        let file = lab.bench.file_of_last_dose(None, None).unwrap();
        let found = lab.bench.weigh_last_dose(&file, &reading, Earlier::Left, &expected).unwrap();
        (found.calibration.displacement.unwrap().reading, found.by_angle_ml)
    };
    let (of_known, none) = unsure(Some(Phase::known(0.3)));
    assert_eq!(none, None);
    let (of_unknown, by_angle_ml) = unsure(None);
    // The volumes from all angles, by hand: the turn delivers them with equal chance.
    let (curve, dose) = (lab.bench.model().outlet_curve(), last(&lab).unwrap());
    let volumes: Vec<f64> = (0..1000)
        .map(|n| {
            let start_rad = f64::from(n) / 1000.0 * curve.pitch_rad();
            curve.volume_ml(start_rad + dose.turned_rad) - curve.volume_ml(start_rad)
        })
        .collect();
    let mean_ml = volumes.iter().sum::<f64>() / 1000.0;
    let standard_ml = (volumes.iter().map(|ml| (ml - mean_ml).powi(2)).sum::<f64>() / 1000.0).sqrt();
    assert!((by_angle_ml.unwrap() / (2.0 * standard_ml) - 1.0).abs() < 0.01, "{by_angle_ml:?} {standard_ml}");
    assert!((of_unknown / of_known.hypot(standard_ml / mean_ml) - 1.0).abs() < 0.01, "{of_unknown}");
}

#[test]
fn a_reading_is_likely_within_twice_the_uncertainty_that_the_dose_had() {
    let lab = Lab::new();
    lab.dose(DoseRequest::dose(213.0));
    let planned_ml = turned_ml(&lab);
    let is_likely = |part: f64| {
        let reading = stated_reading(&format!("{:.3}mL", part * planned_ml)).unwrap();
        let expected = Expected::of_digits(lab.bench.file(), &reading);
        let file = lab.bench.file_of_last_dose(None, None).unwrap();
        lab.bench.weigh_last_dose(&file, &reading, Earlier::Joined, &expected).unwrap().check_likely()
    };
    // 2.4 % of the model and 0.47 % of ten revolutions: four times their root are 9.78 %, and the drop is little.
    assert!(is_likely(1.09).is_ok() && is_likely(0.91).is_ok());
    let error = is_likely(1.11).unwrap_err();
    assert!(matches!(error, CalibrationError::UnlikelyReading { .. }) && is_likely(0.89).is_err(), "{error}");
}

#[test]
fn readings_are_joined_and_the_same_dose_counts_once() {
    let lab = Lab::new();
    let weigh = |text: &str, earlier| {
        let reading = stated_reading(text).unwrap();
        let expected = Expected::of_digits(lab.bench.file(), &reading);
        let file = lab.bench.file_of_last_dose(None, None).unwrap();
        let found = lab.bench.weigh_last_dose(&file, &reading, earlier, &expected).unwrap();
        lab.bench.keep_calibration(found.calibration).unwrap().calibration
    };
    lab.dose(DoseRequest::dose(10.0));
    let planned_ml = turned_ml(&lab);
    weigh("10.50mL", Earlier::Joined);
    // The first reading was a mistake, and the person reads again.
    let first = weigh("10.20mL", Earlier::Joined);
    assert_eq!(first.runs.len(), 1);
    assert!((first.displacement.unwrap().factor - 10.2 / planned_ml).abs() < 1e-9);
    lab.dose(DoseRequest::dose(10.0));
    let second = weigh("10.05mL", Earlier::Joined);
    // Now 5 mL/s takes another speed, and the two doses still show one factor for all speeds.
    let found = second.displacement.clone().unwrap();
    assert_eq!((second.runs.len(), found.speeds_rpm.len()), (2, 1));
    lab.dose(DoseRequest::dose(10.0));
    assert_eq!(weigh("10.00mL", Earlier::Left).runs.len(), 1);
}
