//! Tests of doses of a pump whose displacement depends on the speed.

use pump_model::units::rad_s;

use super::*;
use crate::calibration::{Calibration, CalibrationRun, Displacement, Expected, Reading, Source, Weighing};
use crate::dosing::{DoseRequest, Prepared, Share, ShareSource, Swept};
use crate::record::PhaseSource;

/// Returns a calibration that fits 1 + slope (N - 50) at these speeds exactly.
pub(super) fn stored(file: &PumpFile, slope_per_rpm: f64, speeds_rpm: &[f64]) -> Stored {
    let pump = file.model().unwrap();
    let mut runs = Vec::new();
    for speed_rpm in speeds_rpm {
        let factor = 1.0 + slope_per_rpm * (speed_rpm - 50.0);
        runs.push(CalibrationRun {
            digit: None,
            speed_rpm: *speed_rpm,
            start_angle_deg: Some(13.0),
            start_half_width_deg: None,
            turned_deg: 800.0,
            reading: Reading::VolumeMl(0.0),
            temperature_degc: None,
            time: None,
        });
        let last = runs.last_mut().unwrap();
        last.reading = Reading::VolumeMl(factor * last.model_ml(&pump, 1).unwrap());
    }
    let expected = Expected::new(0.0047, 0.0);
    let displacement = Displacement::fit(&pump, &runs, &Weighing::of(file), &expected).unwrap();
    let mut calibration = Calibration::empty(file, Source::File).unwrap();
    calibration.displacement = Some(displacement);
    calibration.runs = runs;
    Stored { version: 4, calibration }
}

fn planned(
    slope_per_rpm: f64,
    speeds_rpm: &[f64],
    volume_ml: f64,
    cruise: Cruise,
) -> Result<SpeedPlan, DoseError> {
    let file = crate::catalogue::built_in("three-roller").unwrap();
    let pump = SpeedDependentPump::constant(file.model().unwrap());
    let stored = stored(&file, slope_per_rpm, speeds_rpm);
    let planner = Planner { file: &file, pump: &pump, stored: Some(&stored), limits: &file.limits() };
    planner.plan(Phase::known(0.7), &Request::new(volume_ml, cruise))
}

const SPEEDS_RPM: [f64; 3] = [10.0, 60.0, 120.0];

#[test]
fn a_dose_has_the_displacement_of_its_own_cruise_speed() {
    for slope in [-4e-4, 0.0, 4e-4] {
        for rpm in [10.0, 50.0, 120.0] {
            let found = planned(slope, &SPEEDS_RPM, 25.0, Cruise::Speed { rad_s: rad_s(rpm) }).unwrap();
            let factor = 1.0 + slope * (rpm - 50.0);
            assert!((found.applied.as_ref().unwrap().correction.factor - factor).abs() < 1e-12);
            let base = Pump::three_roller();
            let turned = base.outlet_curve().volume_ml(found.plan.end_angle_rad())
                - base.outlet_curve().volume_ml(0.7);
            assert!((found.plan.planned_ml() - factor * turned).abs() < 1e-9);
            assert!((found.plan.planned_ml() - 25.0).abs() < 2e-3, "{}", found.plan.planned_ml());
        }
    }
}

#[test]
fn a_rate_is_had_at_the_root_of_speed_and_displacement() {
    for slope in [-1e-3, 1e-3] {
        let found = planned(slope, &SPEEDS_RPM, 100.0, Cruise::Flow { ml_s: 20.0 }).unwrap();
        let speed_rad_s = found.plan.profile().peak_rad_s();
        assert!((found.model.average_flow_ml_s(speed_rad_s) - 20.0).abs() < 1e-9);
        let factor = 1.0 + slope * (rpm(speed_rad_s) - 50.0);
        assert!((found.applied.as_ref().unwrap().correction.factor - factor).abs() < 1e-12);
    }
}

#[test]
fn a_time_is_met_by_the_slowest_speed_with_its_own_displacement() {
    for slope in [-1e-3, 0.0, 1e-3] {
        for (volume_ml, time_s) in
            [(25.0, 2.3), (25.0, 4.0), (40.0, 4.0), (41.0, 3.0), (80.0, 4.0), (-25.0, 3.0)]
        {
            let found = planned(slope, &SPEEDS_RPM, volume_ml, Cruise::Within { time_s }).unwrap();
            let settle_s = found.plan.predict(&found.model).unwrap().settle_s;
            let takes_s = found.plan.profile().duration_s() + settle_s;
            assert!(
                takes_s <= time_s && takes_s > 0.8 * time_s,
                "{slope} {volume_ml}: {takes_s} of {time_s}"
            );
            let found_rpm = rpm(found.plan.profile().peak_rad_s());
            let factor = 1.0 + slope * (found_rpm - 50.0);
            assert!(
                (found.applied.as_ref().unwrap().correction.factor - factor).abs() < 1e-9,
                "{slope} {volume_ml} {time_s}"
            );
        }
    }
}

#[test]
fn speeds_that_were_not_calibrated_are_refused_with_those_that_were() {
    let refused = |cruise| match planned(-1e-3, &SPEEDS_RPM, 25.0, cruise) {
        Ok(_) => panic!("not refused"),
        Err(error) => error.to_string(),
    };
    let error = refused(Cruise::Speed { rad_s: rad_s(9.0) });
    assert!(
        error.contains("calibration 4 holds from 10.0000 to 120.0000 r/min")
            && error.contains("9.0000 r/min"),
        "{error}"
    );
    let error = refused(Cruise::Flow { ml_s: 45.0 });
    assert!(error.contains("to 39.6") && error.contains("45 mL/s is beyond"), "{error}");
    assert!(refused(Cruise::Flow { ml_s: 500.0 }).contains("500 mL/s is beyond"));
    assert!(refused(Cruise::Within { time_s: 60.0 }).contains("the slowest within 60 s, is beyond"));
    // The motor's own limits refuse what the motor cannot do.
    let error = refused(Cruise::Speed { rad_s: rad_s(171.0) });
    assert!(error.contains("above the pump's limit of 170.00 r/min"), "{error}");
}

#[test]
fn one_speed_is_used_at_every_speed_with_a_warning_and_a_share_for_it() {
    let at = |rpm| planned(0.0, &[50.0], 25.0, Cruise::Speed { rad_s: rad_s(rpm) }).unwrap();
    let warning_of = |found: &SpeedPlan| found.applied.as_ref().unwrap().unweighed_speed.clone();
    assert_eq!(warning_of(&at(50.0)), None);
    let far = at(135.0);
    let warning = warning_of(&far).unwrap();
    // sqrt(12) * 2.4 % over half of the motor's speeds.
    assert!(warning.contains("made at 50 r/min alone") && warning.contains("4.16 %"), "{warning}");
    assert!((far.applied.as_ref().unwrap().sureness().unwrap().speed_dependence - 0.0416).abs() < 1e-4);
    let found = planned(0.0, &[50.0], 25.0, Cruise::Within { time_s: 3.0 }).unwrap();
    assert!(
        found.applied.as_ref().unwrap().sureness().unwrap().speed_dependence > 0.0
            && warning_of(&found).is_some()
    );
}

#[test]
fn a_calibration_of_another_pump_is_refused() {
    let file = crate::catalogue::built_in("three-roller").unwrap();
    let stored = stored(&file, 0.0, &[50.0]);
    let other = crate::catalogue::built_in("two-roller").unwrap();
    let (pump, limits) = (SpeedDependentPump::constant(other.model().unwrap()), other.limits());
    let planner = Planner { file: &other, pump: &pump, stored: Some(&stored), limits: &limits };
    let request = Request::new(25.0, Cruise::Flow { ml_s: 5.0 });
    let Err(error) = planner.plan(Phase::known(0.0), &request) else { panic!("not refused") };
    assert!(error.to_string().contains("a pump with 21.318"), "{error}");
}

/// The interval with the share of the speed over that without it.
fn widened_by_speed(found: &Prepared, file: &PumpFile) -> f64 {
    let budget = found.budget(file, &Swept::whole(&found.model, &found.plan), 0.0);
    let square = |share: &Share| share.standard_ml * share.standard_ml;
    let whole: f64 = budget.shares.iter().map(square).sum();
    let of_speed = budget.shares.iter().find(|share| share.source == ShareSource::SpeedDependence).unwrap();
    (whole / (whole - square(of_speed))).sqrt()
}

#[test]
fn an_unweighed_speed_is_warned_of_where_it_widens_the_interval_notably_and_nowhere_else() {
    let file = crate::catalogue::built_in("three-roller").unwrap();
    let (model, stored) = (file.model().unwrap(), stored(&file, 0.0, &[50.0]));
    for (volume_ml, speed_rpm, warns) in [
        // 3 % faster: 0.07 % of the volume beside 1.4 % of scatter.
        (25.0, 51.5, false),
        (25.0, 55.0, false),
        // 0.98 % beside the 2 % of scatter and calibration, then 2.2 %.
        (25.0, 70.0, true),
        (25.0, 95.0, true),
        // A small dose scatters so much that the speed adds nothing.
        (1.0, 70.0, false),
    ] {
        let request = DoseRequest::dose(volume_ml).with_cruise(Cruise::Speed { rad_s: rad_s(speed_rpm) });
        let found =
            Prepared::calibrated(&file, &model, &stored, request, Phase::known(0.7), PhaseSource::Given, 0.0)
                .unwrap();
        let says = found.warnings.iter().any(|warning| warning.text().contains("made at 50 r/min alone"));
        assert_eq!(says, warns, "{volume_ml} mL at {speed_rpm}: {:?}", found.warnings);
        let widened = widened_by_speed(&found, &file);
        assert_eq!(widened > 1.05, warns, "{volume_ml} mL at {speed_rpm}: {widened}");
    }
}
