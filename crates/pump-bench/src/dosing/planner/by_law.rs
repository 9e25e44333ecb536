//! Tests of doses of a pump whose file has a speed law.

use pump_model::units::rad_s;

use super::*;
use crate::displacement::DisplacementError;
use crate::dosing::{Budget, Swept};
use crate::dosing::{DoseRequest, Prepared};
use crate::pump_file::SpeedLawTable;
use crate::record::{PhaseSource, Purpose};

const PUBLISHED: SpeedLawTable = SpeedLawTable::InletPressure {
    s: 0.953,
    d_per_kpa: 2.05e-3,
    closure_angle_deg: None,
    least_rpm: 10.0,
    most_rpm: 160.0,
    residual_percent: 1.5,
};

fn file(speed_law: SpeedLawTable) -> PumpFile {
    PumpFile { speed_law, ..crate::catalogue::built_in("three-roller").unwrap() }
}

fn prepared(file: &PumpFile, volume_ml: f64, cruise: Cruise) -> Result<Prepared, DoseError> {
    let request = DoseRequest { cruise: Some(cruise), ..DoseRequest::dose(volume_ml) };
    Prepared::new(file, &file.model().unwrap(), request, Phase::known(0.7), PhaseSource::Given, 0.0)
}

fn kappa(file: &PumpFile, speed_rpm: f64) -> f64 {
    file.displacement_law().unwrap().unwrap().factor_at(&file.model().unwrap(), rad_s(speed_rpm)).unwrap()
}

#[test]
fn without_a_law_plans_are_those_of_the_model_to_the_last_bit() {
    let file = file(SpeedLawTable::default());
    let model = file.model().unwrap();
    for cruise in [
        Cruise::Flow { ml_s: 11.0 },
        Cruise::Speed { rad_s: 7.0 },
        Cruise::Within { time_s: 4.0 },
        Cruise::Fastest,
    ] {
        for volume_ml in [25.0, -3.0] {
            let found = prepared(&file, volume_ml, cruise).unwrap();
            let expected = Doser::new(&model, file.limits())
                .unwrap()
                .plan(Phase::known(0.7), &Request::new(volume_ml, cruise))
                .unwrap();
            assert_eq!((found.plan, found.model, found.applied), (expected, model, None));
        }
    }
}

#[test]
fn a_dose_has_the_volume_of_its_own_cruise_speed_whatever_was_asked() {
    let file = file(PUBLISHED);
    for cruise in [
        Cruise::Flow { ml_s: 5.0 },
        Cruise::Flow { ml_s: 45.0 },
        Cruise::Speed { rad_s: rad_s(127.0) },
        Cruise::Within { time_s: 3.1 },
        Cruise::Fastest,
    ] {
        for volume_ml in [40.0, -40.0] {
            let found = prepared(&file, volume_ml, cruise).unwrap();
            let speed_rpm = rpm(found.plan.profile().cruise_rad_s());
            let factor = found.correction().factor;
            let expected = kappa(&file, speed_rpm * volume_ml.signum());
            assert!((factor / expected - 1.0).abs() < 2e-6, "{cruise:?}: {factor} {expected}");
            let curve = *file.model().unwrap().outlet_curve();
            let turned_ml = curve.volume_ml(found.plan.end_angle_rad()) - curve.volume_ml(0.7);
            assert!((found.plan.planned_ml() - factor * turned_ml).abs() < 1e-9);
            assert!((found.plan.planned_ml() - volume_ml).abs() < 3e-3, "{}", found.plan.planned_ml());
            if let Cruise::Flow { ml_s } = cruise {
                assert!((found.plan.cruise_flow_ml_s(&found.model) - ml_s).abs() < 1e-8);
            }
        }
    }
    let fastest = prepared(&file, 100.0, Cruise::Fastest).unwrap();
    assert!(fastest.warnings.iter().any(|warning| warning.text().contains("speed law ends at 160.00")));
}

#[test]
fn speeds_and_flows_that_the_law_does_not_have_are_refused_with_those_that_it_has() {
    let file = file(PUBLISHED);
    let refused = |cruise| prepared(&file, 25.0, cruise).unwrap_err();
    for speed_rpm in [9.0, 165.0] {
        let error = refused(Cruise::Speed { rad_s: rad_s(speed_rpm) }).to_string();
        assert!(error.contains("from 10 to 160 r/min"), "{error}");
    }
    for ml_s in [1.0, 90.0] {
        let error = refused(Cruise::Flow { ml_s });
        let DoseError::Displacement(DisplacementError::OutsideFlows { least_ml_s, most_ml_s, .. }) = error
        else {
            panic!("{error}")
        };
        for ml_s in [least_ml_s, most_ml_s] {
            assert!(prepared(&file, 25.0, Cruise::Flow { ml_s }).is_ok(), "{ml_s} is offered");
        }
    }
    let error = refused(Cruise::Within { time_s: 60.0 }).to_string();
    assert!(error.contains("the slowest within 60 s, is beyond"), "{error}");
    // The motor's own limits refuse what the motor cannot do.
    let error = refused(Cruise::Speed { rad_s: rad_s(171.0) }).to_string();
    assert!(error.contains("above the pump's limit of 170.00 r/min"), "{error}");
}

#[test]
fn the_laws_own_uncertainty_takes_the_models_place_and_runs_to_weigh_are_of_the_model() {
    let file = file(PUBLISHED);
    let found = prepared(&file, 25.0, Cruise::Flow { ml_s: 20.0 }).unwrap();
    let budget = Budget::new(
        &found.model,
        &Swept::whole(&found.model, &found.plan),
        &file.uncertainty,
        found.applied.as_ref(),
    );
    let share_ml =
        |source| budget.shares.iter().find(|share| share.source.as_str() == source).unwrap().standard_ml;
    assert!((share_ml("speed_law") - 0.015 * found.plan.planned_ml()).abs() < 1e-12);
    assert_eq!((share_ml("model"), share_ml("temperature")), (0.0, 0.0));

    let request = DoseRequest {
        purpose: Purpose::Calibrate,
        cruise: Some(Cruise::Speed { rad_s: rad_s(165.0) }),
        ..DoseRequest::dose(50.0)
    };
    let model = file.model().unwrap();
    let run = Prepared::new(&file, &model, request, Phase::known(0.0), PhaseSource::Given, 0.0).unwrap();
    assert_eq!((run.model, run.applied), (model, None));
}
