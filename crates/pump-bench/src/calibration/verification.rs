//! Verification: systematic and random error of repeated doses, as ISO 8655-6 reports them.

use libm::sqrt;
use serde::Serialize;

use crate::files::Table;

use super::{CalibrationError, Weighing};

/// Fewest doses whose error can be told apart from chance; ISO 8655-6:2002 asks for ten.
const FEWEST: usize = 2;

/// Largest errors that a verification allows.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Tolerance {
    /// Largest systematic error either way, in percent of the nominal volume.
    pub systematic_percent: f64,
    /// Largest random error (coefficient of variation), in percent.
    pub random_percent: f64,
}

impl Tolerance {
    /// Returns the errors that ISO 8655-5:2002 allows a dispenser of 10 mL, or `None` for other nominal
    /// volumes.
    pub fn of_standard(nominal_ml: f64) -> Option<Self> {
        let is_10_ml = (nominal_ml - 10.0).abs() < 1e-9;
        is_10_ml.then_some(Self { systematic_percent: 0.6, random_percent: 0.2 })
    }
}

/// Result of repeated doses of one volume.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Verification {
    /// Schema of the report: `verification/1`.
    pub schema: &'static str,
    /// Volume that every dose should have, in mL.
    pub nominal_ml: f64,
    /// Measured volume of each dose, in mL.
    pub volumes_ml: Vec<f64>,
    /// Mean volume, in mL.
    pub mean_ml: f64,
    /// Systematic error: mean less nominal volume, in mL.
    pub systematic_ml: f64,
    /// Systematic error, in percent of the nominal volume.
    pub systematic_percent: f64,
    /// Random error: standard deviation of the doses, n - 1 degrees of freedom, in mL.
    pub random_ml: f64,
    /// Coefficient of variation: random error, in percent of the mean.
    pub random_percent: f64,
    /// Errors that are allowed.
    pub tolerance: Tolerance,
    /// True if both errors are allowed.
    pub passed: bool,
}

impl Verification {
    /// Returns the errors of doses that should be `nominal_ml` (ISO 8655-6:2002, evaluation): e_s = mean -
    /// V_n, s_r = sqrt(sum (V_i - mean)²/(n - 1)), and CV = s_r/mean.
    ///
    /// # Errors
    ///
    /// [`CalibrationError::TooFew`] with fewer than two doses.
    pub fn of(nominal_ml: f64, volumes_ml: Vec<f64>, tolerance: Tolerance) -> Result<Self, CalibrationError> {
        let count = volumes_ml.len();
        if count < FEWEST {
            return Err(CalibrationError::TooFew { given: count, of: "doses", needed: FEWEST });
        }
        let mean_ml = volumes_ml.iter().sum::<f64>() / count as f64;
        let squares = volumes_ml.iter().map(|volume_ml| (volume_ml - mean_ml) * (volume_ml - mean_ml));
        let random_ml = sqrt(squares.sum::<f64>() / (count - 1) as f64);
        let systematic_ml = mean_ml - nominal_ml;
        let (systematic_percent, random_percent) =
            (100.0 * systematic_ml / nominal_ml, 100.0 * random_ml / mean_ml);
        let passed = systematic_percent.abs() <= tolerance.systematic_percent
            && random_percent <= tolerance.random_percent;
        Ok(Self {
            schema: "verification/1",
            nominal_ml,
            volumes_ml,
            mean_ml,
            systematic_ml,
            systematic_percent,
            random_ml,
            random_percent,
            tolerance,
            passed,
        })
    }
}

/// Reads volumes, in mL, from a table of doses: CSV with `mass_g` or `volume_ml`, and perhaps
/// `temperature_degc`.
///
/// # Errors
///
/// [`CalibrationError::Table`] with the line of a cell that is not as it should be. Errors of
/// [`Weighing::volume_ml`] if the density of the fluid is not known at the temperature of a dose.
pub fn readings_of_csv(text: &str, weighing: &Weighing<'_>) -> Result<Vec<f64>, CalibrationError> {
    let table = Table::parse(text, &["mass_g", "volume_ml", "temperature_degc", "time"])?;
    let mut volumes_ml = Vec::new();
    for row in table.rows() {
        let (name, value, is_mass) = row.one_of([("mass_g", true), ("volume_ml", false)])?;
        if value <= 0.0 {
            return Err(row.error(format!("{name} is {value}; allowed: more than 0")).into());
        }
        let degc = row.number("temperature_degc")?.unwrap_or(weighing.fluid.temperature_degc);
        volumes_ml.push(if is_mass { weighing.volume_ml(value, degc)? } else { value });
    }
    Ok(volumes_ml)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEN: [f64; 10] = [10.02, 10.01, 10.03, 9.99, 10.0, 10.04, 10.02, 10.01, 10.02, 10.03];

    #[test]
    fn errors_are_those_of_the_standard() {
        let tolerance = Tolerance::of_standard(10.0).unwrap();
        let found = Verification::of(10.0, TEN.to_vec(), tolerance).unwrap();
        // Mean 10.017, squares of the deviations 0.00201, over 9.
        assert!(
            (found.systematic_ml - 0.017).abs() < 1e-12 && (found.systematic_percent - 0.17).abs() < 1e-10
        );
        assert!((found.random_ml - 0.014_944).abs() < 1e-6 && (found.random_percent - 0.149_19).abs() < 1e-4);
        assert!(found.passed && found.text().starts_with("PASSED: 10 doses of 10 mL"), "{}", found.text());
    }

    #[test]
    fn either_error_fails_it_and_only_ten_millilitres_have_a_tolerance_of_their_own() {
        let tolerance = |systematic_percent, random_percent| Tolerance { systematic_percent, random_percent };
        let found = |tolerance| Verification::of(10.0, TEN.to_vec(), tolerance).unwrap();
        assert!(!found(tolerance(0.16, 0.2)).passed);
        let scattered = found(tolerance(0.6, 0.14));
        assert!(!scattered.passed && scattered.text().contains("BEYOND 0.14 %"), "{}", scattered.text());
        assert_eq!(Tolerance::of_standard(25.0), None);
        assert!(Verification::of(10.0, vec![10.0], tolerance(1.0, 1.0)).is_err());
    }

    #[test]
    fn a_table_of_masses_becomes_volumes() {
        let file = crate::catalogue::built_in("three-roller").unwrap();
        let weighing = Weighing::of(&file);
        let volumes_ml = readings_of_csv("mass_g,temperature_degc\n10,20\n10,25\n", &weighing).unwrap();
        assert!((volumes_ml[0] - 10.0265).abs() < 1e-3 && volumes_ml[1] > volumes_ml[0], "{volumes_ml:?}");
        assert!(readings_of_csv("volume_ml\n-1\n", &weighing).is_err());
    }
}
