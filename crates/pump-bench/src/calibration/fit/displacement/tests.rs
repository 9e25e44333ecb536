//! Fits to runs whose truth is known.

use pump_model::SpeedLaw;

use super::*;
use crate::calibration::{CalibrationError, CalibrationRun, Expected, LawToFit, Weighing};
use crate::sampling::Dice;

const EXPECTED: Expected = Expected::new(0.0047, 0.0);

fn run(speed_rpm: f64, volume_ml: f64) -> CalibrationRun {
    CalibrationRun {
        digit: None,
        speed_rpm,
        start_angle_deg: None,
        start_half_width_deg: None,
        turned_deg: 720.0,
        reading: crate::calibration::Reading::VolumeMl(volume_ml),
        temperature_degc: None,
        time: None,
    }
}

/// Fits runs of two revolutions whose volumes are the model's times these factors.
fn fit(runs: &[(f64, f64)], expected: &Expected) -> Result<Displacement, CalibrationError> {
    let file = crate::catalogue::built_in("three-roller").unwrap();
    let pump = file.model().unwrap();
    let runs: Vec<CalibrationRun> =
        runs.iter().map(|(rpm, factor)| run(*rpm, 2.0 * pump.revolution_ml() * factor)).collect();
    Displacement::fit(&pump, &runs, &Weighing::of(&file), expected)
}

#[test]
fn a_line_through_several_speeds_is_found_exactly() {
    let truth = |rpm: f64| 1.03 - 2e-4 * (rpm - 50.0);
    let runs: Vec<(f64, f64)> = [20.0, 60.0, 100.0].iter().flat_map(|rpm| [(*rpm, truth(*rpm)); 2]).collect();
    let fit = fit(&runs, &EXPECTED).unwrap();
    assert!(fit.is_line() && fit.scatter.degrees_of_freedom() == 3);
    assert_eq!(fit.speeds_rpm, [20.0, 60.0, 100.0]);
    assert!((fit.slope_per_rpm + 2e-4).abs() < 1e-12);
    for rpm in [20.0, 33.0, 100.0] {
        assert!((fit.kappa_at(rpm) - truth(rpm)).abs() < 1e-12);
    }
    assert!(
        fit.standard_at(&Pump::three_roller(), 60.0).unwrap() < 1e-9
            && fit.outliers.is_empty()
            && fit.lack_of_fit < 1e-9
    );
    assert!(fit.covers(20.0) && fit.covers(100.0) && !fit.covers(19.0) && !fit.covers(102.0));
    assert_eq!((fit.distance_rpm(60.1), fit.distance_rpm(90.0)), (0.0, 10.0));
}

#[test]
fn one_run_is_as_sure_as_was_expected_and_no_surer() {
    let expected = Expected { reading_ml: 0.1, ..EXPECTED };
    let fit = fit(&[(60.0, 0.98)], &expected).unwrap();
    assert!((fit.factor - 0.98).abs() < 1e-12 && fit.slope_per_rpm == 0.0 && !fit.is_line());
    assert_eq!(fit.scatter, Scatter::Expected);
    let reading = 0.1 / (0.98 * 2.0 * 21.318_5);
    assert!((fit.reading - reading).abs() < 1e-6);
    let standard = fit.standard_at(&Pump::three_roller(), 60.0).unwrap();
    assert!((standard - 0.98 * sqrt(0.0047 * 0.0047 + reading * reading)).abs() < 1e-6);
    assert!(fit.covers(1.0) && fit.covers(170.0), "one speed is used at all of them");
}

#[test]
fn one_run_is_expected_to_scatter_as_a_dose_of_its_volume_does() {
    let file = crate::catalogue::built_in("three-roller").unwrap();
    let (pump, expected) = (file.model().unwrap(), Expected::of(&file, 0.0));
    let of_turns = |turns: f64, expected: &Expected| {
        let run = CalibrationRun { turned_deg: 360.0 * turns, ..run(60.0, turns * pump.revolution_ml()) };
        Displacement::fit(&pump, &[run], &Weighing::of(&file), expected).unwrap().factor_standard
    };
    // Ten revolutions of the paper scatter by 0.47 %, two of independent pitches by 0.47 % sqrt(10/2), and twenty
    // no less than 0.47 %.
    for (turns, standard) in [(2.0, 0.010_509), (10.0, 0.0047), (20.0, 0.0047)] {
        let found = of_turns(turns, &expected);
        assert!((found - standard).abs() < 1e-6, "{turns} revolutions: {found}");
    }
    // A pump file that names the volume of its doses: two revolutions are more than 10 mL.
    let verified = Expected { repeatability_at_ml: Some(10.0), ..expected };
    assert!((of_turns(2.0, &verified) - 0.0047).abs() < 1e-9);
}

#[test]
fn standard_errors_are_those_of_repeated_calibrations() {
    let (mut dice, n) = (Dice::new(7), 2000);
    let (mut inside, mut squares, mut slopes) = (0, 0.0, 0.0);
    let mut expected_slope = 0.0;
    for _ in 0..n {
        let runs: Vec<(f64, f64)> = [20.0, 60.0, 100.0]
            .iter()
            .flat_map(|rpm| [*rpm; 3])
            .map(|rpm| (rpm, 1.0 + 1e-4 * rpm + 0.003 * dice.normal()))
            .collect();
        let fit = fit(&runs, &EXPECTED).unwrap();
        inside += i32::from(
            (fit.kappa_at(80.0) - 1.008).abs() < 2.0 * fit.standard_at(&Pump::three_roller(), 80.0).unwrap(),
        );
        squares += fit.scatter.standard().unwrap() * fit.scatter.standard().unwrap();
        slopes += (fit.slope_per_rpm - 1e-4) * (fit.slope_per_rpm - 1e-4);
        expected_slope += fit.slope_standard_per_rpm * fit.slope_standard_per_rpm;
    }
    let covered = f64::from(inside) / f64::from(n);
    assert!((0.94..0.97).contains(&covered), "{covered}");
    assert!((sqrt(squares / f64::from(n)) / 0.003 - 1.0).abs() < 0.03);
    assert!((sqrt(slopes / expected_slope) - 1.0).abs() < 0.05);
}

#[test]
fn an_outlier_is_named_and_kept_and_honest_runs_are_rarely_accused() {
    let mut runs = vec![
        (20.0, 1.001),
        (20.0, 0.999),
        (20.0, 1.0),
        (60.0, 1.002),
        (60.0, 1.001),
        (60.0, 0.9995),
        (100.0, 1.0),
        (100.0, 1.0008),
        (100.0, 0.9991),
    ];
    assert!(fit(&runs, &EXPECTED).unwrap().outliers.is_empty());
    runs[4].1 = 1.03;
    let spoiled = fit(&runs, &EXPECTED).unwrap();
    assert_eq!((spoiled.outliers.as_slice(), spoiled.scatter.degrees_of_freedom()), (&[5][..], 6));
    let (mut dice, mut accused) = (Dice::new(3), 0);
    for _ in 0..1000 {
        let runs = runs.iter().map(|(rpm, _)| (*rpm, 1.0 + 0.0047 * dice.normal())).collect::<Vec<_>>();
        accused += fit(&runs, &EXPECTED).unwrap().outliers.len();
    }
    assert!(accused < 150, "{accused} of 9000");
}

#[test]
fn a_bend_that_no_line_has_is_reported() {
    let bent = |rpm: f64| 1.0 + 4e-6 * (rpm - 60.0) * (rpm - 60.0);
    let mut dice = Dice::new(1);
    let runs: Vec<(f64, f64)> = [20.0, 60.0, 100.0]
        .iter()
        .flat_map(|rpm| [*rpm; 3])
        .map(|rpm| (rpm, bent(rpm) + 1e-4 * dice.normal()))
        .collect();
    let fit = fit(&runs, &EXPECTED).unwrap();
    // The three means lie 0.0021, -0.0043 and 0.0021 from the line, on one degree of freedom.
    assert!((0.004..0.007).contains(&fit.lack_of_fit), "{}", fit.lack_of_fit);
    // The bend is no scatter.
    assert!(
        fit.scatter.standard().unwrap() < 2e-4
            && fit.standard_at(&Pump::three_roller(), 60.0).unwrap() < 2e-4,
        "{fit:?}"
    );
}

#[test]
fn a_speed_gives_its_flow_and_no_speed_gives_more_than_the_line_has() {
    for slope in [-1e-3, 0.0, 1e-3] {
        let runs: Vec<(f64, f64)> =
            [20.0, 60.0, 100.0].iter().map(|rpm| (*rpm, 1.0 + slope * (rpm - 60.0))).collect();
        let fit = fit(&runs, &EXPECTED).unwrap();
        for rpm in [25.0, 77.0, 100.0] {
            let flow_ml_s = fit.kappa_at(rpm) * 21.318_5 * rpm / 60.0;
            assert!((fit.speed_for_flow(21.318_5, flow_ml_s).unwrap() - rpm).abs() < 1e-9, "{slope} {rpm}");
        }
    }
    // kappa(N) N is largest where N = 530: 0.53 * 530 * 21.3/60.
    let falling = fit(&[(20.0, 1.04), (60.0, 1.0), (100.0, 0.96)], &EXPECTED).unwrap();
    assert!(falling.speed_for_flow(21.318_5, 99.0).is_some());
    assert!(falling.speed_for_flow(21.318_5, 101.0).is_none());
}

#[test]
fn what_cannot_be_is_refused() {
    assert!(fit(&[], &EXPECTED).unwrap_err().to_string().contains("0 runs; 1 at least"));
    let error = fit(&[(60.0, 1.0), (60.0, 2.1)], &EXPECTED).unwrap_err().to_string();
    assert!(error.contains("run 2 gave 89.5377 mL where the model gives 42.6370 mL"), "{error}");
}

/// Fits runs of a pump that follows this law, two revolutions each, with this scatter.
fn by_law(
    law: &SpeedLaw,
    speeds_rpm: &[f64],
    scatter: f64,
    dice: &mut Dice,
) -> Result<Displacement, CalibrationError> {
    let file = crate::catalogue::built_in("three-roller").unwrap();
    let pump = file.model().unwrap();
    let volume_ml = |rpm: f64| 2.0 * law.revolution_ml(&pump, rad_s(rpm)).unwrap();
    let runs: Vec<CalibrationRun> = speeds_rpm
        .iter()
        .flat_map(|rpm| [*rpm; 3])
        .map(|rpm| run(rpm, volume_ml(rpm) * (1.0 + scatter * dice.normal())))
        .collect();
    let to_fit = LawToFit::of(&file, &pump).unwrap();
    Displacement::fit_law(&to_fit, &pump, &runs, &Weighing::of(&file), &EXPECTED)
}

#[test]
fn a_speed_law_is_found_exactly_where_nothing_scatters() {
    let law = SpeedLaw { scale: 0.97, distensibility_per_kpa: 1.3e-3, ..SpeedLaw::PUBLISHED };
    let found = by_law(&law, &[20.0, 60.0, 110.0, 160.0], 0.0, &mut Dice::new(1)).unwrap();
    let fit = found.law.unwrap();
    assert!((fit.scale - 0.97).abs() < 1e-7 && (fit.distensibility_per_kpa / 1.3e-3 - 1.0).abs() < 1e-5);
    let pump = Pump::three_roller();
    for rpm in [20.0, 47.0, 133.0, 160.0] {
        let expected = law.factor(&pump, rad_s(rpm)).unwrap();
        assert!((found.factor_at(&pump, rpm).unwrap() - expected).abs() < 1e-7, "{rpm}");
    }
    assert!(found.lack_of_fit < 1e-6, "{}", found.lack_of_fit);
}

#[test]
fn the_errors_of_a_speed_law_are_those_of_repeated_calibrations() {
    let (mut dice, n, pump) = (Dice::new(9), 1000, Pump::three_roller());
    let law = SpeedLaw::PUBLISHED;
    let factor = law.factor(&pump, rad_s(85.0)).unwrap();
    let mut inside = [0; 3];
    for _ in 0..n {
        let found = by_law(&law, &[20.0, 60.0, 110.0, 160.0], 0.003, &mut dice).unwrap();
        let fit = found.law.unwrap();
        let (s, d) = (fit.scale - law.scale, fit.distensibility_per_kpa - law.distensibility_per_kpa);
        let kappa = found.factor_at(&pump, 85.0).unwrap() - factor;
        let standards = [
            fit.scale_standard,
            fit.distensibility_standard_per_kpa,
            found.standard_at(&pump, 85.0).unwrap(),
        ];
        for ((inside, error), standard) in inside.iter_mut().zip([s, d, kappa]).zip(standards) {
            *inside += u32::from(error.abs() < 2.0 * standard);
        }
    }
    for inside in inside {
        assert!((930..=980).contains(&inside), "{inside} of {n}");
    }
}

#[test]
fn a_law_that_the_runs_do_not_show_is_refused() {
    let law = SpeedLaw { distensibility_per_kpa: 0.0, ..SpeedLaw::PUBLISHED };
    let error = by_law(&law, &[20.0, 160.0], 0.0, &mut Dice::new(1)).unwrap_err().to_string();
    assert!(error.contains("2 speeds for a speed law; 3 at least"), "{error}");
    // More volume where less pressure trapped it.
    let pump = Pump::three_roller();
    let file = crate::catalogue::built_in("three-roller").unwrap();
    let runs: Vec<CalibrationRun> = [20.0, 60.0, 110.0, 160.0]
        .iter()
        .map(|rpm| {
            let kpa = SpeedLaw::PUBLISHED.trapped_kpa(&pump, rad_s(*rpm)).unwrap();
            run(*rpm, 42.6 * (1.0 - 1e-3 * (kpa - 85.7)))
        })
        .collect();
    let to_fit = LawToFit::of(&file, &pump).unwrap();
    let fit = Displacement::fit_law(&to_fit, &pump, &runs, &Weighing::of(&file), &EXPECTED);
    let error = fit.unwrap_err().to_string();
    assert!(error.contains("do not fit a speed law") && error.contains("fit a line"), "{error}");
}
