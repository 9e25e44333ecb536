//! Claims about R from flows and pressures, and C from an injection.

use pump_model::identification::{ComplianceFit, FlowPoint, InjectionPoint, ResistanceFit};
use pump_model::metrics::{nrmse, pearson, rmse};

use crate::dice::{Coverage, Dice};

fn flow_points(of: impl Fn(f64) -> f64, noise_kpa: f64, dice: &mut Dice) -> Vec<FlowPoint> {
    (1..=8)
        .map(|n| 5.0 * f64::from(n))
        .map(|flow_ml_s| FlowPoint {
            flow_ml_s,
            drop_kpa: of(flow_ml_s) + noise_kpa * dice.normal(),
            standard_kpa: 1.0,
        })
        .collect()
}

#[test]
fn a_resistance_is_recovered_within_its_error_as_often_as_stated() {
    let mut dice = Dice(1);
    let [mut through, mut beside, mut offset] = [(); 3].map(|()| Coverage::default());
    for _ in 0..200 {
        let resistance = dice.between(0.05, 0.2);
        let fit = ResistanceFit::of(&flow_points(|q| resistance * q, 0.05, &mut dice), false).unwrap();
        through.take(fit.resistance_kpa_s_ml, resistance);
        let shifted = flow_points(|q| -0.7 + resistance * q, 0.05, &mut dice);
        let fit = ResistanceFit::of(&shifted, true).unwrap();
        beside.take(fit.resistance_kpa_s_ml, resistance);
        offset.take(fit.offset_kpa.unwrap(), -0.7);
        assert!((fit.scatter / 0.05 - 1.0).abs() < 0.9, "{}", fit.scatter);
    }
    [through, beside, offset].iter().for_each(Coverage::is_as_stated);
}

#[test]
fn a_resistance_that_grows_with_the_flow_is_said_to_and_a_straight_one_hardly_ever() {
    let mut dice = Dice(2);
    let [mut at_no_flow, mut per_flow] = [(); 2].map(|()| Coverage::default());
    let mut false_alarms = 0;
    for _ in 0..200 {
        let bent = |q: f64| 0.02 * q + 0.0006 * q * q.abs();
        let fit = ResistanceFit::of(&flow_points(bent, 0.01, &mut dice), false).unwrap();
        let bend = fit.bend.unwrap();
        at_no_flow.take(bend.at_no_flow_kpa_s_ml, 0.02);
        per_flow.take(bend.per_flow_kpa_s2_ml2, 0.0006);
        assert!((bend.resistance_kpa_s_ml(-30.0) - 0.038).abs() < 3e-3 && bend.scatter < fit.scatter);
        let straight = flow_points(|q| 0.1 * q, 0.01, &mut dice);
        false_alarms += u32::from(ResistanceFit::of(&straight, false).unwrap().bend.is_some());
    }
    [at_no_flow, per_flow].iter().for_each(Coverage::is_as_stated);
    // The expected count is 9: 4.55 % of 200.
    assert!(false_alarms <= 18, "{false_alarms}");
}

#[test]
fn an_offset_that_was_not_sought_is_told_and_hardly_ever_where_there_is_none() {
    let mut dice = Dice(5);
    let mut false_alarms = 0;
    for _ in 0..200 {
        let beside = flow_points(|q| 1.0 + 0.1 * q, 0.02, &mut dice);
        let missed = ResistanceFit::of(&beside, false).unwrap().missed_offset_kpa.unwrap();
        assert!((missed.value - 1.0).abs() < 5.0 * missed.standard, "{missed:?}");
        assert_eq!(ResistanceFit::of(&beside, true).unwrap().missed_offset_kpa, None);
        let through = flow_points(|q| 0.1 * q, 0.02, &mut dice);
        false_alarms += u32::from(ResistanceFit::of(&through, false).unwrap().missed_offset_kpa.is_some());
    }
    // The expected count is 9: 4.55 % of 200.
    assert!(false_alarms <= 18, "{false_alarms}");
}

#[test]
fn a_point_weighs_as_its_uncertainty_says_and_reverse_flow_counts() {
    let point = |flow_ml_s, drop_kpa, standard_kpa| FlowPoint { flow_ml_s, drop_kpa, standard_kpa };
    let points = [point(10.0, 1.0, 1.0), point(10.0, 1.2, 2.0), point(-20.0, -2.0, 1.0)];
    // The fit is R = sum(w Q dP)/sum(w Q²) with w = 1, 1/4, 1.
    let expected = (10.0 + 3.0 + 40.0) / (100.0 + 25.0 + 400.0);
    let fit = ResistanceFit::of(&points, false).unwrap();
    assert!((fit.resistance_kpa_s_ml.value - expected).abs() < 1e-15);
    let twice = points.map(|point| FlowPoint { standard_kpa: 2.0 * point.standard_kpa, ..point });
    let other = ResistanceFit::of(&twice, false).unwrap();
    let ratio = other.resistance_kpa_s_ml.standard / fit.resistance_kpa_s_ml.standard;
    assert!((ratio - 1.0).abs() < 1e-12, "the ratios count");
}

#[test]
fn a_compliance_is_recovered_within_its_error_as_often_as_stated() {
    let mut dice = Dice(3);
    let [mut compliance, mut start, mut modulus] = [(); 3].map(|()| Coverage::default());
    for _ in 0..200 {
        let truth = dice.between(0.01, 0.06);
        let points: Vec<_> = (0..7)
            .map(|n| 0.05 * f64::from(n))
            .map(|volume_ml| InjectionPoint {
                volume_ml,
                pressure_kpa: 88.637 + volume_ml / truth + 0.05 * dice.normal(),
            })
            .collect();
        let fit = ComplianceFit::of(&points).unwrap();
        compliance.take(fit.compliance_ml_kpa, truth);
        start.take(fit.start_kpa, 88.637);
        modulus.take(fit.bulk_modulus_kpa(26.0), 26.0 / truth);
        let pairs = points.iter().map(|point| (fit.pressure_kpa(point.volume_ml), point.pressure_kpa));
        assert!(rmse(pairs.clone()).unwrap() < 0.15 && nrmse(pairs.clone()).unwrap() < 2e-3);
        assert!(pearson(pairs).unwrap() > 0.99);
    }
    [compliance, start, modulus].iter().for_each(Coverage::is_as_stated);
}

#[test]
fn air_in_the_line_shows_as_a_bend() {
    let points: Vec<_> = (0..7)
        .map(|n| 0.1 * f64::from(n))
        // The line holds 1 mL of air at 100 kPa, compressed at constant temperature.
        .map(|volume_ml| InjectionPoint { volume_ml, pressure_kpa: 100.0 / (1.0 - volume_ml) })
        .collect();
    let (slope, growth) = ComplianceFit::of(&points).unwrap().bend.unwrap();
    assert!(slope.value > 0.0 && growth.value > 0.0, "{slope:?} {growth:?}");
}
