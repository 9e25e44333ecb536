//! Doses of a calibrated pump from start to record.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::ops::ControlFlow;

use pump_bench::calibration::{
    Calibration, CalibrationRun, Displacement, Expected, Reading, Source, Weighing,
};
use pump_bench::report::DoseReport;
use pump_bench::{Bench, Delivered, DoseRequest, Prepared, built_in};

/// A pulse as a stored calibration has it: 5 % more roller volume than the model, over 0.53 deg less.
const PULSE: &str = r#"{
    "roller_volume_ml": 2.2107, "roller_volume_standard_ml": 0.007,
    "engagement_deg": 50.0, "engagement_standard_deg": 0.2,
    "correlations": [0.89, 0.86, 0.97], "repeatability": 0.0047, "reading_ml": 0.002
}"#;

/// A bench whose calibration says that a revolution delivers `factor` times the model's volume, with another pulse, at
/// a zero of 20 deg.
fn bench(folder: &std::path::Path, factor: f64) -> Bench {
    let bench = Bench::new(built_in("three-roller").unwrap(), None, folder).unwrap();
    let run = CalibrationRun {
        digit: None,
        speed_rpm: 14.0,
        start_angle_deg: None,
        start_half_width_deg: None,
        turned_deg: 720.0,
        reading: Reading::VolumeMl(2.0 * factor * bench.model().revolution_ml()),
        temperature_degc: None,
        time: None,
    };
    let expected = Expected::new(0.0047, 0.0);
    let displacement =
        Displacement::fit(bench.model(), &[run], &Weighing::of(bench.file()), &expected).unwrap();
    let mut calibration = Calibration::empty(bench.file(), Source::File).unwrap();
    calibration.displacement = Some(displacement);
    calibration.zero_deg = 20.0;
    calibration.zero_standard_deg = 0.2;
    calibration.pulse = serde_json::from_str(PULSE).unwrap();
    let calibrations = bench.calibrations();
    let version = calibrations.add(&calibration).unwrap();
    calibrations.activate(Some(version)).unwrap();
    bench
}

#[test]
fn a_calibrated_dose_that_was_stopped_is_on_record_and_resumed_as_it_was_calibrated() {
    let folder = tempfile::tempdir().unwrap();
    let bench = bench(folder.path(), 1.03);
    let request = DoseRequest::dose(25.0);
    let first: (Prepared, Delivered) = {
        let mut session = bench.session().unwrap();
        let prepared = session.prepare(request).unwrap();
        let stop = |made| if made >= 3000 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
        let delivered = session.run(&prepared, stop).unwrap();
        (prepared, delivered)
    };
    assert!(!first.1.completed && (first.0.plan.planned_ml() - 25.0).abs() < 2e-3);
    // The calibration in use now does not change the volume delivered then.
    bench.calibrations().activate(None).unwrap();
    let unfinished = bench.story().unwrap().state.unwrap().unfinished.unwrap();
    let (least_ml, most_ml) = unfinished.delivered_ml(bench.model());
    assert!(
        (least_ml - first.1.volume_ml).abs() < 1e-5 && least_ml == most_ml,
        "{least_ml} {}",
        first.1.volume_ml
    );

    bench.calibrations().activate(Some(1)).unwrap();
    let mut session = bench.session().unwrap();
    let rest = session.prepare_rest(DoseRequest::dose(0.0)).unwrap();
    let second = session.run(&rest, |_| ControlFlow::Continue(())).unwrap();
    assert!(second.completed);
    let all_ml = first.1.volume_ml + second.volume_ml;
    assert!((all_ml - 25.0).abs() < 2e-3, "{all_ml}");
    assert_eq!(rest.plan.end_angle_rad(), first.0.plan.end_angle_rad());
}

#[test]
fn a_retraction_of_a_calibrated_dose_is_as_large_as_was_asked() {
    let folder = tempfile::tempdir().unwrap();
    let bench = bench(folder.path(), 0.96);
    let mut session = bench.session().unwrap();
    let prepared = session.prepare(DoseRequest::dose(10.0).with_retraction(0.5)).unwrap();
    let delivered = session.run(&prepared, |_| ControlFlow::Continue(())).unwrap();
    assert!((delivered.volume_ml - 10.0).abs() < 2e-3 && (delivered.retracted_ml - 0.5).abs() < 2e-3);
    assert!((session.state().unwrap().carry_ml - 0.5).abs() < 2e-3);
}

#[test]
fn a_fitted_pulse_is_the_pulse_of_the_pump_that_later_doses_are_planned_for() {
    let folder = tempfile::tempdir().unwrap();
    let bench = bench(folder.path(), 1.02);
    let mut session = bench.session().unwrap();
    let prepared = session.prepare(DoseRequest::dose(1.0)).unwrap();
    // V_nom - NU V_r = 27.63489 - 3 * 2.2107 mL, scaled to a revolution of 1.02 * 21.31849 mL.
    let scale = 1.02 * 21.318_49 / (27.634_89 - 3.0 * 2.2107);
    let roller = prepared.model.roller_volume();
    assert!((roller.total_ml() - 2.2107 * scale).abs() < 1e-4, "{}", roller.total_ml());
    assert!((roller.engagement_deg() - 50.0).abs() < 1e-9);
    let report = DoseReport::new(&bench, &prepared, None);
    let share_ml = |name: &str| {
        let share = report.uncertainty_budget.iter().find(|share| share.source.as_str() == name);
        share.map_or(0.0, |share| share.standard_ml)
    };
    assert!(share_ml("pulse") > 0.0 && share_ml("roller_volume") == 0.0, "{:?}", report.uncertainty_budget);
    let used = report.calibration.unwrap();
    assert_eq!((used.roller_volume_ml, used.engagement_deg), (Some(2.2107), Some(50.0)));
    let delivered = session.run(&prepared, |_| ControlFlow::Continue(())).unwrap();
    assert!(delivered.completed && (delivered.volume_ml - 1.0).abs() < 2e-3, "{}", delivered.volume_ml);
}
