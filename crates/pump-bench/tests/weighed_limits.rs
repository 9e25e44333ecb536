//! Limits of motions that are booked by the model without calibration: runs to be weighed, and turns.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::ops::ControlFlow;
use std::path::Path;

use pump_bench::calibration::{Calibration, CalibrationRun, Expected, Fit, Reading, Source};
use pump_bench::dosing::FlowProfile;
use pump_bench::pump_file::{PumpFile, SpeedLawTable};
use pump_bench::record::Purpose;
use pump_bench::{Bench, DoseError, DoseReport, DoseRequest, Prepared, built_in};
use pump_ctl::plan::{Cruise, LimitedBy, PlanError};
use pump_model::units::rad_s;

/// Eight pitches of the three-roller pump, in mL.
const RUN_ML: f64 = 56.849_297_6;

const SPEED_RPM: f64 = 100.0;

fn file(max_outlet_kpa: f64) -> PumpFile {
    let mut file = built_in("three-roller").unwrap();
    file.limits.max_outlet_kpa = Some(max_outlet_kpa);
    file
}

/// Has doses of `bench` use a calibration by runs of two revolutions at these speeds, `factor` times the model each.
fn calibrate(bench: &Bench, speeds_rpm: &[f64], factor: f64) {
    let runs = speeds_rpm.iter().map(|speed_rpm| CalibrationRun {
        digit: None,
        speed_rpm: *speed_rpm,
        start_angle_deg: None,
        start_half_width_deg: None,
        turned_deg: 720.0,
        reading: Reading::VolumeMl(2.0 * factor * bench.model().revolution_ml()),
        temperature_degc: None,
        time: None,
    });
    let expected = Expected::of(bench.file(), 0.0);
    let calibration =
        Calibration::of_runs(bench.file(), Source::File, runs.collect(), Fit::Line, &expected, None);
    bench.keep_calibration(calibration.unwrap()).unwrap();
}

fn asked(purpose: Purpose) -> DoseRequest {
    let cruise = Some(Cruise::Speed { rad_s: rad_s(SPEED_RPM) });
    DoseRequest::new(purpose, RUN_ML).with_cruise(cruise)
}

/// A bench with a calibration and this limit of the outlet pressure.
fn bench(folder: &Path, limit_kpa: f64, speeds_rpm: &[f64], factor: f64) -> Bench {
    let bench = Bench::new(file(limit_kpa), None, folder).unwrap();
    calibrate(&bench, speeds_rpm, factor);
    bench
}

/// Largest pressure at the outlet in a dose of eight pitches at 100 r/min, in kPa.
fn highest_kpa(speeds_rpm: &[f64], factor: f64) -> f64 {
    let folder = tempfile::tempdir().unwrap();
    let bench = bench(folder.path(), 500.0, speeds_rpm, factor);
    let prepared = bench.prepare(asked(Purpose::Dose)).unwrap();
    prepared.prediction.outlet.max_kpa + prepared.prediction.step_kpa
}

/// A limit between the highest pressures of a dose with two calibrations, at the same speeds.
fn between_kpa(speeds_rpm: &[f64], factors: [f64; 2]) -> f64 {
    let [one, other] = factors.map(|factor| highest_kpa(speeds_rpm, factor));
    assert!((one - other).abs() > 2.0, "{one} {other}");
    0.5 * (one + other)
}

fn assert_breaks_limit<T: std::fmt::Debug>(found: Result<T, DoseError>, limit: f64) {
    let Err(DoseError::Plan(PlanError::OutletPressure { limit_kpa, predicted_kpa, .. })) = found else {
        panic!("{found:?}")
    };
    assert!(limit_kpa == limit && predicted_kpa > limit, "{predicted_kpa} of {limit_kpa}");
}

fn both(bench: &Bench) -> [Result<Prepared, DoseError>; 2] {
    [Purpose::Dose, Purpose::Calibrate].map(|purpose| bench.prepare(asked(purpose)))
}

#[test]
fn a_run_to_weigh_is_refused_where_the_calibrated_dose_is() {
    let limit_kpa = between_kpa(&[60.0], [1.0, 1.3]);
    let folder = tempfile::tempdir().unwrap();
    let bench = bench(folder.path(), limit_kpa, &[60.0], 1.3);
    let [dose, run] = both(&bench);
    assert_breaks_limit(dose, limit_kpa);
    assert_breaks_limit(run, limit_kpa);
}

#[test]
fn a_run_to_weigh_runs_where_the_calibrated_dose_does_and_tells_its_pressures() {
    let limit_kpa = between_kpa(&[60.0], [0.75, 1.0]);
    let folder = tempfile::tempdir().unwrap();
    let bench = bench(folder.path(), limit_kpa, &[60.0], 0.75);
    let [dose, run] = both(&bench).map(Result::unwrap);
    // Eight pitches by the model, as its reading is compared with them: the dose turns farther for its volume.
    assert_eq!(run.plan.steps(), 34_133);
    assert!(dose.plan.steps() > 40_000, "{}", dose.plan.steps());
    let highest = |prepared: &Prepared| prepared.prediction.outlet.max_kpa;
    assert!((highest(&run) - highest(&dose)).abs() < 0.2, "{} {}", highest(&run), highest(&dose));
    assert!(run.margins.outlet.unwrap().used < 1.0, "{:?}", run.margins);
}

#[test]
fn a_run_at_a_speed_beyond_the_calibrated_ones_holds_limits_by_the_nearest_and_by_the_model() {
    // A calibration that ends at 60 r/min says what the pump displaces there, and nobody knows at 100.
    for factors in [[1.0, 1.3], [0.75, 1.0]] {
        let limit_kpa = between_kpa(&[60.0], factors);
        let factor = factors[usize::from(factors[0] == 1.0)];
        let folder = tempfile::tempdir().unwrap();
        let bench = bench(folder.path(), limit_kpa, &[20.0, 60.0], factor);
        let [dose, run] = both(&bench);
        assert!(matches!(dose, Err(DoseError::Calibration(_))), "{dose:?}");
        assert_breaks_limit(run, limit_kpa);
    }
    // Where both hold, the speed can be calibrated.
    let folder = tempfile::tempdir().unwrap();
    let bench = bench(folder.path(), highest_kpa(&[60.0], 1.3) + 1.0, &[20.0, 60.0], 1.3);
    assert!(both(&bench)[1].is_ok());
}

#[test]
fn a_run_at_a_speed_beyond_the_calibrated_ones_tells_the_pressures_of_the_nearest_and_of_the_model() {
    for factor in [0.75, 1.3] {
        let folder = tempfile::tempdir().unwrap();
        let run =
            both(&bench(folder.path(), 500.0, &[20.0, 60.0], factor)).into_iter().nth(1).unwrap().unwrap();
        let [model_kpa, nearest_kpa] = [1.0, factor].map(|factor| highest_kpa(&[60.0], factor));
        let (found_kpa, worst_kpa) = (run.margins.outlet.unwrap().reached, f64::max(model_kpa, nearest_kpa));
        // The dose turns farther or less far than the run, by the factor.
        assert!((found_kpa - worst_kpa).abs() < 0.2, "{factor}: {found_kpa} of {worst_kpa}");
        let predicted_kpa = run.prediction.outlet.max_kpa + run.prediction.step_kpa;
        assert!((found_kpa - predicted_kpa).abs() < 1e-6, "{found_kpa} {predicted_kpa}");
    }
}

#[test]
fn a_run_that_is_to_be_as_fast_as_possible_is_slowed_until_its_limits_hold() {
    for (speeds_rpm, factor) in
        [(&[60.0][..], 1.3), (&[20.0, 60.0], 1.3), (&[20.0, 60.0], 0.75), (&[60.0], 1.0)]
    {
        let limit_kpa = between_kpa(&[60.0], [0.75, 1.3]);
        let folder = tempfile::tempdir().unwrap();
        let bench = bench(folder.path(), limit_kpa, speeds_rpm, factor);
        let request = asked(Purpose::Calibrate).with_cruise(Cruise::Fastest);
        let run = bench.prepare(request).unwrap();
        let reached_kpa = run.margins.outlet.unwrap().reached;
        assert!(
            (limit_kpa - 0.5..=limit_kpa).contains(&reached_kpa),
            "{factor}: {reached_kpa} of {limit_kpa}"
        );
        assert_eq!((run.plan.limited_by(), run.plan.steps()), (LimitedBy::OutletPressure, 34_133));
    }
}

#[test]
fn a_run_to_weigh_holds_limits_by_the_pump_files_law() {
    let law = SpeedLawTable::InletPressure {
        s: 0.7,
        d_per_kpa: 2.05e-3,
        closure_angle_deg: None,
        least_rpm: 10.0,
        most_rpm: 160.0,
        residual_percent: 1.5,
    };
    let (folder, other) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let lawful = |limit_kpa, folder: &Path| {
        let mut file = file(limit_kpa);
        file.speed_law = law;
        Bench::new(file, None, folder).unwrap()
    };
    let dose = lawful(500.0, folder.path()).prepare(asked(Purpose::Dose)).unwrap();
    let limit_kpa = 0.5 * (dose.prediction.outlet.max_kpa + highest_kpa(&[60.0], 1.0));
    assert!(highest_kpa(&[60.0], 1.0) > limit_kpa + 2.0, "the model alone breaks it");
    let [dose, run] = both(&lawful(limit_kpa, other.path()));
    assert!(dose.is_ok() && run.is_ok(), "{dose:?} {run:?}");
}

#[test]
fn a_turn_holds_limits_by_the_calibrated_pump() {
    let limit_kpa = between_kpa(&[60.0], [1.0, 1.3]);
    let goes = |_| ControlFlow::Continue(());
    let folder = tempfile::tempdir().unwrap();
    let bench = bench(folder.path(), limit_kpa, &[60.0], 1.3);
    {
        let mut session = bench.session().unwrap();
        assert_breaks_limit(session.jog(34_133, rad_s(SPEED_RPM), goes), limit_kpa);
        assert!(!session.has_moved());
        // A turn that the calibrated pump holds is booked by the steps that it makes.
        assert_eq!(session.jog(1280, rad_s(10.0), goes).unwrap(), 1280);
    }
    bench.use_calibration(None).unwrap();
    assert_eq!(bench.session().unwrap().jog(34_133, rad_s(SPEED_RPM), goes).unwrap(), 34_133);
}

#[test]
fn a_flow_over_time_warns_where_its_peak_is_faster_than_anything_that_was_weighed() {
    let folder = tempfile::tempdir().unwrap();
    let ml_s_per_rpm = built_in("three-roller").unwrap().model().unwrap().average_flow_ml_s(rad_s(1.0));
    let warns = |bench: &Bench, peak_rpm: f64| {
        let peak = peak_rpm * ml_s_per_rpm;
        // Most of the volume passes at a speed that was weighed.
        let main = 6.0 * ml_s_per_rpm;
        let (times_s, flows) = ([0.0, 4.0, 64.0, 66.0, 70.0], [0.0, main, main, peak, 0.0]);
        let profile = FlowProfile::from_columns("peak", &times_s, &flows).unwrap();
        let prepared = bench.prepare_profile(DoseRequest::new(Purpose::Run, 0.0), &profile).unwrap();
        let report = DoseReport::by_profile(bench, &prepared, None);
        let told: Vec<&str> = report.warnings.iter().map(|warning| warning.text()).collect();
        told.into_iter().find(|text| text.contains("this flow goes up to")).map(str::to_owned)
    };
    let bench = Bench::new(file(500.0), None, folder.path()).unwrap();
    assert_eq!(warns(&bench, 9.0), None, "nothing was weighed");
    calibrate(&bench, &[6.0], 1.05);
    let told = warns(&bench, 9.0).unwrap();
    assert!(
        told.starts_with("calibration 1 was made at 6 r/min alone, and this flow goes up to 8.57"),
        "{told}"
    );
    calibrate(&bench, &[2.0, 5.0, 8.0], 1.05);
    let told = warns(&bench, 9.0).unwrap();
    assert!(
        told.starts_with("calibration 2 was made at 2 to 8 r/min, and this flow goes up to 8.57"),
        "{told}"
    );
    assert_eq!(warns(&bench, 7.0), None);
}
