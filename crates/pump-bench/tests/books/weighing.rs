//! The last dose, as a scale can weigh it: how far the rollers turned for what is in the vessel.

use pump_bench::DoseRequest;
use pump_bench::calibration::{CalibrationError, CalibrationRun, Earlier, Expected, Reading};
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
    let pump = lab.bench.model();
    let run = |lab: &Lab| CalibrationRun::of_last_dose(last(lab), pump, Reading::MassG(5.0), 25.0);
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
fn from_an_unknown_angle_only_whole_pitches_are_weighed() {
    let lab = Lab::new();
    lab.home(None);
    let reading = Reading::MassG(5.0);
    lab.dose(DoseRequest::dose(5.0));
    let run = CalibrationRun::of_last_dose(last(&lab), lab.bench.model(), reading, 25.0);
    assert!(matches!(run, Err(CalibrationError::LastDoseFromUnknownAngle { .. })), "{run:?}");
    lab.home(None);
    lab.dose(DoseRequest::dose(2.0 * lab.bench.model().revolution_ml()));
    let run = CalibrationRun::of_last_dose(last(&lab), lab.bench.model(), reading, 25.0).unwrap();
    assert_eq!(run.start_angle_deg, None);
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
