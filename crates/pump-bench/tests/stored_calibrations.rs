//! Calibrations that earlier versions stored: they are read, written as they were, and found again from their
//! runs.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::fs;
use std::path::Path;

use pump_bench::built_in;
use pump_bench::calibration::{Calibration, Displacement, Expected, Fit};

/// Reads a sample and shows that it is written as it was.
fn sample(name: &str) -> Calibration {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/samples/calibrations");
    let text = fs::read_to_string(folder.join(name)).unwrap();
    let calibration: Calibration = serde_json::from_str(&text).unwrap();
    calibration.check_schema().unwrap();
    assert_eq!(serde_json::to_string_pretty(&calibration).unwrap() + "\n", text, "{name}");
    calibration
}

/// Fits the runs of a stored calibration again, of readings with this standard uncertainty.
fn again(stored: &Calibration, fit: Fit, reading_ml: f64) -> Displacement {
    let file = built_in("three-roller").unwrap();
    let expected = Expected::of(&file, reading_ml);
    let found = Calibration::of_runs(&file, stored.source, stored.runs.clone(), fit, &expected, None);
    found.unwrap().displacement.unwrap()
}

fn assert_near(found: f64, stored: f64, part: f64) {
    assert!((found - stored).abs() <= part * stored.abs(), "{found} {stored}");
}

/// Compares a fit with the one on disk, which an earlier version made.
fn assert_same(found: &Displacement, stored: &Displacement) {
    for (found, stored) in [
        (found.reference_rpm, stored.reference_rpm),
        (found.factor, stored.factor),
        (found.factor_standard, stored.factor_standard),
        (found.slope_per_rpm, stored.slope_per_rpm),
        (found.slope_standard_per_rpm, stored.slope_standard_per_rpm),
    ] {
        assert_near(found, stored, 1e-9);
    }
    // That version took them as parts of the model's volume, and this one takes them as parts of the weighed volume.
    for (found_part, stored_part) in [
        (found.scatter.standard().unwrap(), stored.scatter.standard().unwrap()),
        (found.lack_of_fit, stored.lack_of_fit),
    ] {
        assert_near(found.factor * found_part, stored_part, 1e-3);
    }
    assert_eq!(found.scatter.degrees_of_freedom(), stored.scatter.degrees_of_freedom());
    assert_eq!((&found.speeds_rpm, &found.outliers), (&stored.speeds_rpm, &stored.outliers));
}

#[test]
fn a_stored_line_is_read_and_found_again() {
    let stored = sample("line.json");
    let line = stored.displacement.as_ref().unwrap();
    assert!(line.law.is_none() && line.scatter.degrees_of_freedom() == 6);
    // The runs were read to 0.02 g.
    assert_same(&again(&stored, Fit::Line, 0.02 / 0.997_047), line);
}

#[test]
fn a_stored_speed_law_is_read_and_found_again() {
    let stored = sample("speed-law.json");
    let known = stored.displacement.as_ref().unwrap();
    let found = again(&stored, Fit::Law, 0.0);
    assert_same(&found, known);
    let (found, known) = (found.law.unwrap(), known.law.unwrap());
    for (found, known) in [
        (found.scale, known.scale),
        (found.scale_standard, known.scale_standard),
        (found.distensibility_per_kpa, known.distensibility_per_kpa),
        (found.distensibility_standard_per_kpa, known.distensibility_standard_per_kpa),
        (found.reference_kpa, known.reference_kpa),
    ] {
        assert_near(found, known, 1e-9);
    }
}

#[test]
fn a_stored_zero_is_read_and_found_again() {
    let stored = sample("phase.json");
    assert!(stored.displacement.is_none() && stored.short_doses.len() == 15);
    let file = built_in("three-roller").unwrap();
    let expected = Expected::of(&file, 0.0);
    let (_, found) = Calibration::of_short_doses(&file, stored.short_doses.clone(), &expected, None).unwrap();
    // The search ends where a step could gain 1e-12 of the sum of squares.
    assert!((found.zero_deg.value - stored.zero_deg).abs() < 1e-5 * stored.zero_standard_deg, "{found:?}");
    assert_near(found.zero_deg.standard, stored.zero_standard_deg, 1e-5);
    assert!((found.roller_volume_ml.value - 2.095_611_689).abs() < 1e-6, "{found:?}");
    assert!((found.engagement_deg.value - 50.325_539_11).abs() < 1e-4, "{found:?}");
    assert!((found.scatter_ml - 0.020_761_789).abs() < 1e-8, "{found:?}");
}

#[test]
fn a_scatter_without_degrees_of_freedom_is_refused() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/samples/calibrations");
    let text = fs::read_to_string(folder.join("line.json")).unwrap();
    let spoiled = text.replace("\"degrees_of_freedom\": 6", "\"degrees_of_freedom\": 0");
    let error = serde_json::from_str::<Calibration>(&spoiled).unwrap_err().to_string();
    assert!(error.contains("with degrees_of_freedom 0; allowed: null, or a number with"), "{error}");
}
