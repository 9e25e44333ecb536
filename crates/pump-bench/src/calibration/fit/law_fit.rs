//! The speed law fitted to runs. Nothing else of a calibration knows its parameters.

use std::fmt;

use libm::sqrt;
use pump_model::identification::least_squares::StraightLine;
use pump_model::identification::widening;
use pump_model::units::{TURN_RAD, degrees, radians};
use pump_model::{ModelError, Pump, SpeedLaw};
use serde::{Deserialize, Serialize};

use super::points::Points;
use crate::calibration::CalibrationError;
use crate::displacement::DisplacementLaw;
use crate::pump_file::PumpFile;

/// s and D of the speed law, by weighted least squares.
///
/// Over a revolution kappa = (A s - B)(1 + D p). p is the pressure at which a segment is trapped less P_atm,
/// A = V_nom/V_rot, and B = NU (V_r + V(theta_c))/(2 V_rot). This is a straight line over p, kappa = u + w p,
/// with s = (u + B)/A and D = w/u. So the fit is that of the line over the speed, with the pressure in the
/// speed's place.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct LawFit {
    /// s: volume between two rollers over that of the round tube.
    pub scale: f64,
    /// Standard uncertainty of s with that of the readings, widened so that twice it covers 95 % whatever the
    /// number of runs.
    pub scale_standard: f64,
    /// D, in 1/kPa.
    pub distensibility_per_kpa: f64,
    /// Standard uncertainty of D, in 1/kPa, widened so that twice it covers 95 % whatever the number of runs.
    pub distensibility_standard_per_kpa: f64,
    /// theta_c, in deg.
    pub(crate) closure_deg: f64,
    /// P_atm, in kPa absolute.
    pub(crate) ambient_kpa: f64,
    /// Weighted mean of the pressures at which segments were trapped, in kPa absolute. kappa and its slope
    /// are independent there.
    pub reference_kpa: f64,
    /// Standard error of kappa at the reference pressure.
    pub(crate) factor_standard: f64,
    /// Standard error of the slope of kappa over the pressure, in 1/kPa.
    pub(crate) slope_standard_per_kpa: f64,
}

/// A speed law of a pump whose s and D are sought.
pub(crate) struct LawToFit<'a> {
    /// Law with theta_c and P_atm of the pump.
    start: SpeedLaw,
    /// Pump as it is without law, counted from its own zero.
    base: &'a Pump,
}

impl<'a> LawToFit<'a> {
    /// Returns the law to fit of `base`, the pump of `file` as it is without law, counted from its own zero.
    ///
    /// # Errors
    ///
    /// [`ModelError`] of dimensions from which no closure angle follows.
    pub(crate) fn of(file: &PumpFile, base: &'a Pump) -> Result<Self, ModelError> {
        Ok(Self { start: file.speed_law_to_fit()?, base })
    }

    /// Returns the straight line of the runs over the pressure at which each trapped its segments.
    ///
    /// # Errors
    ///
    /// [`CalibrationError::Undetermined`] if the pressure is the same in all runs. [`CalibrationError::Model`]
    /// where the pump or the law cannot be computed.
    pub(super) fn line(&self, points: &Points) -> Result<LineOverPressure<'_>, CalibrationError> {
        let trapped_kpa = points.speeds_rad_s().map(|speed| self.start.trapped_kpa(self.base, speed));
        let trapped_kpa: Vec<f64> = trapped_kpa.collect::<Result<_, _>>()?;
        let line = points.over(&trapped_kpa).ok_or(CalibrationError::Undetermined {
            what: "a speed law",
            why: "the pressure at the inlet is the same at all speeds; take more speeds, or fit a line",
        })?;
        Ok(LineOverPressure { law: self, trapped_kpa, line })
    }
}

/// Straight line of kappa over the trapped pressure, in kPa absolute.
pub(super) struct LineOverPressure<'a> {
    law: &'a LawToFit<'a>,
    trapped_kpa: Vec<f64>,
    pub(super) line: StraightLine,
}

impl LineOverPressure<'_> {
    /// Returns the fitted kappa of each run.
    pub(super) fn fitted(&self) -> impl Iterator<Item = f64> {
        self.trapped_kpa.iter().map(|kpa| self.line.at(*kpa))
    }

    /// Returns the law of the line, which stands over the `level` of the runs. `standards` are those of the line's
    /// factor and slope; `reading` is the part of the volume that no mean reduces.
    ///
    /// # Errors
    ///
    /// [`CalibrationError::NoLaw`] if D is negative, or s or D out of range.
    pub(super) fn law(
        &self,
        standards: [f64; 2],
        (level, reading): (f64, f64),
        degrees_of_freedom: u32,
    ) -> Result<LawFit, CalibrationError> {
        let (LawToFit { start, base }, line) = (self.law, &self.line);
        let [factor_standard, slope_standard_per_kpa] = standards.map(|part| level * part);
        let revolution_ml = base.revolution_ml();
        let a = TURN_RAD * base.geometry().nominal_ml_rad() / revolution_ml;
        let b = start.pinched_ml(base) / revolution_ml;
        let away_kpa = start.ambient_kpa - line.reference;
        let (u, w) = (level * line.at(start.ambient_kpa), level * line.slope.value);
        let (slope_variance, reference_variance) =
            (slope_standard_per_kpa * slope_standard_per_kpa, factor_standard * factor_standard);
        let u_variance = reference_variance + slope_variance * away_kpa * away_kpa;
        let d = w / u;
        // First order: dD = dw/u - D du/u, and du and dw have slope_variance away_kpa in common.
        let d_variance =
            (slope_variance + d * d * u_variance - 2.0 * d * slope_variance * away_kpa) / (u * u);
        let wide = widening(degrees_of_freedom);
        let fit = LawFit {
            scale: (u + b) / a,
            scale_standard: sqrt(wide * wide * u_variance + u * u * reading * reading) / a,
            distensibility_per_kpa: d,
            distensibility_standard_per_kpa: wide * sqrt(d_variance.max(0.0)),
            closure_deg: degrees(start.closure_rad),
            ambient_kpa: start.ambient_kpa,
            reference_kpa: line.reference,
            factor_standard,
            slope_standard_per_kpa,
        };
        if d < 0.0 || fit.law().validate().is_err() {
            return Err(CalibrationError::NoLaw {
                scale: fit.scale,
                d_per_kpa: d,
                standard_per_kpa: fit.distensibility_standard_per_kpa,
            });
        }
        Ok(fit)
    }
}

impl LawFit {
    /// Returns kappa of `base`, the pump as it is without law, at a speed in rad/s, negative in reverse.
    ///
    /// # Errors
    ///
    /// [`ModelError`] where the law cannot be computed for this pump and speed.
    pub(super) fn factor_at(&self, base: &Pump, speed_rad_s: f64) -> Result<f64, ModelError> {
        self.law().factor(base, speed_rad_s)
    }

    /// Returns the standard errors of kappa at a speed in rad/s that its value at the reference pressure and
    /// its slope make.
    ///
    /// # Errors
    ///
    /// [`ModelError`] where the law cannot be computed for this pump and speed.
    pub(super) fn standards_at(&self, base: &Pump, speed_rad_s: f64) -> Result<[f64; 2], ModelError> {
        let away_kpa = self.law().trapped_kpa(base, speed_rad_s)? - self.reference_kpa;
        Ok([self.factor_standard, self.slope_standard_per_kpa * away_kpa])
    }

    /// Returns the law that was found, as it holds between two speeds in r/min.
    pub(super) fn between(&self, range_rpm: [f64; 2]) -> DisplacementLaw {
        DisplacementLaw::new(self.law(), range_rpm)
    }

    /// Returns the parameters in words, with their expanded uncertainties.
    pub(crate) fn text_with_uncertainty(&self) -> String {
        format!(
            "s {:.5} ± {:.5}, D {:.3e} ± {:.1e} /kPa (k = 2)",
            self.scale,
            2.0 * self.scale_standard,
            self.distensibility_per_kpa,
            2.0 * self.distensibility_standard_per_kpa
        )
    }

    /// Returns the law with the s and D that were found.
    fn law(&self) -> SpeedLaw {
        SpeedLaw {
            scale: self.scale,
            distensibility_per_kpa: self.distensibility_per_kpa,
            closure_rad: radians(self.closure_deg),
            ambient_kpa: self.ambient_kpa,
        }
    }
}

impl fmt::Display for LawFit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "s {:.4}, D {:.2e} /kPa", self.scale, self.distensibility_per_kpa)
    }
}
