//! Fits to runs whose truth is a line or a parabola.

use super::*;
use crate::calibration::{CalibrationRun, Expected, Reading, Weighing};
use crate::sampling::Dice;

const EXPECTED: Expected = Expected::new(0.0047, 0.0);
const SPEEDS_RPM: [f64; 4] = [20.0, 60.0, 110.0, 160.0];

/// Fits three runs at each speed, of two revolutions each, whose volumes are the model's times `factor`.
fn best(speeds_rpm: &[f64], mut factor: impl FnMut(f64) -> f64) -> Displacement {
    let file = crate::catalogue::built_in("three-roller").unwrap();
    let pump = file.model().unwrap();
    let runs: Vec<CalibrationRun> = speeds_rpm
        .iter()
        .flat_map(|rpm| [*rpm; 3])
        .map(|speed_rpm| CalibrationRun {
            digit: None,
            speed_rpm,
            start_angle_deg: None,
            start_half_width_deg: None,
            turned_deg: 720.0,
            reading: Reading::VolumeMl(2.0 * pump.revolution_ml() * factor(speed_rpm)),
            temperature_degc: None,
            time: None,
        })
        .collect();
    Displacement::fit_best(&pump, &runs, &Weighing::of(&file), &EXPECTED).unwrap()
}

fn parabola(rpm: f64) -> f64 {
    1.01 + 1e-4 * (rpm - 80.0) - 4e-6 * (rpm - 80.0) * (rpm - 80.0)
}

#[test]
fn a_parabola_is_found_where_it_is_and_a_line_keeps_what_it_was() {
    let mut n = 0;
    // Runs of one speed differ by 1e-5, so that they scatter.
    let found = best(&SPEEDS_RPM, |rpm| {
        n += 1;
        parabola(rpm) + 1e-5 * f64::from(n % 3 - 1)
    });
    let bend = found.bend.unwrap();
    assert!((bend.per_rpm2 + 4e-6).abs() < 1e-9, "{bend:?}");
    for rpm in [20.0, 45.0, 99.0, 160.0] {
        assert!((found.kappa_at(rpm) - parabola(rpm)).abs() < 2e-6, "{rpm}");
    }
    assert!(found.lack_of_fit < 1e-5, "{}", found.lack_of_fit);
    let stored = serde_json::to_string(&found).unwrap();
    assert_eq!(serde_json::from_str::<Displacement>(&stored).unwrap(), found);
    // Three speeds show no parabola, however far they lie from a line.
    let three = best(&[20.0, 80.0, 160.0], |rpm| {
        n += 1;
        parabola(rpm) + 1e-5 * f64::from(n % 3 - 1)
    });
    assert!(three.bend.is_none() && three.lack_of_fit > 0.005, "{three:?}");
}

#[test]
fn a_flow_has_the_slowest_speed_that_gives_it_on_a_parabola_too() {
    let mut n = 0;
    // Strong bends: the flow rises, falls or turns within the speeds.
    for bend in [-4e-5, -1e-5, 1e-5, 4e-5] {
        let truth = |rpm: f64| 1.0 + bend * (rpm - 60.0) * (rpm - 60.0);
        let found = best(&SPEEDS_RPM, |rpm| {
            n += 1;
            truth(rpm) + 1e-6 * f64::from(n % 3 - 1)
        });
        assert!(found.bend.is_some());
        let flow_ml_s = |rpm: f64| found.kappa_at(rpm) * 21.3185 * rpm / 60.0;
        let grid = || (0..=140_000).map(|n| 20.0 + 0.001 * f64::from(n));
        let largest = grid().map(flow_ml_s).fold(0.0, f64::max);
        let largest_ml_s = flow_ml_s(found.largest_flow_rpm(20.0, 160.0));
        assert!((largest_ml_s - largest).abs() < 1e-6, "{bend}: {largest_ml_s} {largest}");
        for part in [0.3, 0.7, 0.95, 0.999] {
            let wanted = part * largest;
            let slowest = grid().find(|rpm| flow_ml_s(*rpm) >= wanted).unwrap();
            let speed_rpm = found.speed_for_flow(21.3185, wanted).unwrap();
            let in_range = speed_rpm >= 20.0;
            assert!(!in_range || (speed_rpm - slowest).abs() < 2e-3, "{bend} {part}: {speed_rpm} {slowest}");
            assert!((flow_ml_s(speed_rpm) - wanted).abs() < 1e-9, "{bend} {part}: {speed_rpm}");
        }
        let most_ml_s = flow_ml_s(found.largest_flow_rpm(0.0, 161.5));
        assert_eq!(found.speed_for_flow(21.3185, 1.01 * most_ml_s), None, "{bend}");
    }
}

#[test]
fn lines_are_taken_for_parabolas_as_often_as_the_level_says() {
    const SETS: u32 = 4000;
    let mut dice = Dice::new(41);
    let mut bent = 0;
    for _ in 0..SETS {
        let found = best(&SPEEDS_RPM, |rpm| (1.02 - 2e-4 * (rpm - 60.0)) * (1.0 + 0.0047 * dice.normal()));
        bent += u32::from(found.bend.is_some());
    }
    // 4.55 % of 4000 is 182, and three binomial deviations are 40.
    assert!((142..=222).contains(&bent), "{bent}");
}

#[test]
fn the_uncertainty_of_a_volume_covers_parabolas_that_are_found_and_those_that_are_not() {
    const SETS: u32 = 3000;
    let mut dice = Dice::new(43);
    let base = Pump::three_roller();
    // From a bend that nobody sees to one of 5 % over the speeds.
    for bend in [0.0, 5e-7, 1e-6, 2e-6, 1e-5] {
        let (mut inside, mut line_inside, mut bent) = (0, 0, 0);
        for n in 0..SETS {
            let truth = |rpm: f64| 1.02 - 1e-4 * (rpm - 60.0) + bend * (rpm - 90.0) * (rpm - 90.0);
            let found = best(&SPEEDS_RPM, |rpm| truth(rpm) * (1.0 + 0.0047 * dice.normal()));
            let rpm = [20.0, 40.0, 60.0, 85.0, 110.0, 135.0, 160.0][n as usize % 7];
            let error = (found.factor_at(&base, rpm).unwrap() - truth(rpm)).abs();
            inside += u32::from(error <= 2.0 * found.whole_standard_at(&base, rpm).unwrap());
            line_inside += u32::from(error <= 2.0 * found.standard_at(&base, rpm).unwrap());
            bent += u32::from(found.bend.is_some());
        }
        let part = f64::from(inside) / f64::from(SETS);
        let without = f64::from(line_inside) / f64::from(SETS);
        assert!(part >= 0.93, "{bend}: {part}, {without} without the lack of fit, {bent} of {SETS} bent");
    }
}
