//! The speed law fitted to runs.

use pump_model::identification::least_squares::StraightLine;
use pump_model::identification::widening;
use pump_model::math::{TURN_RAD, degrees, radians, sqrt};
use pump_model::{Pump, SpeedLaw};
use serde::{Deserialize, Serialize};

use crate::calibration::CalibrationError;

/// s and D of the speed law, by weighted least squares.
///
/// Over a revolution kappa = (A s - B)(1 + D p). p is the pressure at which a segment is trapped less P_atm,
/// A = V_nom/V_rot, and B = NU (V_r + V(theta_c))/(2 V_rot). This is a straight line over p, kappa = u + w p,
/// with s = (u + B)/A and D = w/u. So the fit is that of the line over the speed, with the pressure in the
/// speed's place.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
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
    pub closure_deg: f64,
    /// P_atm, in kPa absolute.
    pub ambient_kpa: f64,
    /// Weighted mean of the pressures at which segments were trapped, in kPa absolute. kappa and its slope
    /// are independent there.
    pub reference_kpa: f64,
    /// Standard error of kappa at the reference pressure.
    pub factor_standard: f64,
    /// Standard error of the slope of kappa over the pressure, in 1/kPa.
    pub slope_standard_per_kpa: f64,
}

impl LawFit {
    /// Returns the law of `line`, kappa over the trapped pressure in kPa absolute, of `pump`, the pump as it
    /// is without law. theta_c and P_atm are those of `start`; `standards` are those of the line's factor and
    /// slope; `reading` is the part of the volume that no mean reduces.
    ///
    /// # Errors
    ///
    /// [`CalibrationError::NoLaw`] if D is negative, or s or D out of range.
    pub(super) fn of(
        pump: &Pump,
        start: &SpeedLaw,
        line: &StraightLine,
        standards: [f64; 2],
        reading: f64,
        degrees_of_freedom: u32,
    ) -> Result<Self, CalibrationError> {
        let [factor_standard, slope_standard_per_kpa] = standards;
        let revolution_ml = pump.revolution_ml();
        let a = TURN_RAD * pump.geometry().nominal_ml_rad() / revolution_ml;
        let b = start.pinched_ml(pump) / revolution_ml;
        let away_kpa = start.ambient_kpa - line.reference;
        let (u, w) = (line.at(start.ambient_kpa), line.slope.value);
        let (slope_variance, reference_variance) =
            (slope_standard_per_kpa * slope_standard_per_kpa, factor_standard * factor_standard);
        let u_variance = reference_variance + slope_variance * away_kpa * away_kpa;
        let d = w / u;
        // First order: dD = dw/u - D du/u, and du and dw have slope_variance away_kpa in common.
        let d_variance =
            (slope_variance + d * d * u_variance - 2.0 * d * slope_variance * away_kpa) / (u * u);
        let wide = widening(degrees_of_freedom);
        let fit = Self {
            scale: (u + b) / a,
            scale_standard: sqrt(wide * wide * u_variance + reading * reading) / a,
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

    /// Returns the law with the s and D that were found.
    pub fn law(&self) -> SpeedLaw {
        SpeedLaw {
            scale: self.scale,
            distensibility_per_kpa: self.distensibility_per_kpa,
            closure_rad: radians(self.closure_deg),
            ambient_kpa: self.ambient_kpa,
        }
    }
}
