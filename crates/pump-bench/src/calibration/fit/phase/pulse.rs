//! Short doses as a least-squares problem: residuals, their derivatives, and the search for the best zero.

use libm::sqrt;
use pump_model::identification::least_squares::{Found, Residuals, Triangle, search};
use pump_model::units::radians;
use pump_model::{ModelError, Pump};

use crate::calibration::CalibrationError;
use crate::calibration::fit::expected::Expected;
use crate::calibration::fit::short_dose::ShortDose;
use crate::displacement::PulseCorrection;

/// Number of parameters: V_r over the model's, phi over the model's, and the zero, in rad.
pub(super) const PARAMETERS: usize = 3;
pub(super) const ROLLER: usize = 0;
pub(super) const ENGAGEMENT: usize = 1;
pub(super) const ZERO: usize = 2;

/// Zeros that the search starts from, over a pitch.
const STARTS: u32 = 36;

/// Change of a parameter by which its effect is measured, as a part of V_r and phi, and in rad.
const PROBE: f64 = 1e-5;

/// Doses of a pump whose volume of a revolution is known and whose pulse is sought.
pub(super) struct Pulse<'a> {
    pub(super) pump: &'a Pump,
    /// Volume of a revolution over the model's, for each dose.
    pub(super) factors: &'a [f64],
    /// Factor on every volume of the model. It shows the effect of the revolution's uncertainty.
    pub(super) tilt: f64,
    pub(super) doses: &'a [ShortDose],
    pub(super) expected: &'a Expected,
}

impl<'a> Pulse<'a> {
    fn model(&self, at: &[f64; PARAMETERS]) -> Result<Pump, ModelError> {
        let roller = self.pump.roller_volume();
        let pulse = PulseCorrection {
            roller_volume_ml: at[ROLLER] * roller.total_ml(),
            engagement_deg: at[ENGAGEMENT] * roller.engagement_deg(),
        };
        pulse.of(self.pump)?.shifted(at[ZERO])?.scaled(self.tilt)
    }

    /// Measured volumes less those of the model, in mL.
    fn residuals_ml<'b>(
        &'b self,
        at: &[f64; PARAMETERS],
    ) -> Result<impl Iterator<Item = f64> + use<'a, 'b>, ModelError> {
        let pump = self.model(at)?;
        Ok(self.doses.iter().zip(self.factors).map(move |(dose, factor)| {
            let curve = pump.outlet_curve();
            let start_rad = radians(dose.start_angle_deg);
            let model_ml = curve.volume_ml(start_rad + radians(dose.turned_deg)) - curve.volume_ml(start_rad);
            dose.volume_ml - factor * model_ml.abs()
        }))
    }

    /// Residuals over the standard deviations that are expected of the doses.
    fn residuals<'b>(
        &'b self,
        at: &[f64; PARAMETERS],
    ) -> Result<impl Iterator<Item = f64> + use<'a, 'b>, ModelError> {
        let sigma_ml = move |dose: &ShortDose| {
            let repeated_ml = self.expected.repeatability * dose.volume_ml;
            sqrt(repeated_ml * repeated_ml + self.expected.reading_ml * self.expected.reading_ml).max(1e-9)
        };
        let pairs = self.residuals_ml(at)?.zip(self.doses);
        Ok(pairs.map(move |(residual_ml, dose)| residual_ml / sigma_ml(dose)))
    }

    /// Standard deviation of the doses about the model, in mL.
    pub(super) fn scatter_ml(&self, at: &[f64; PARAMETERS]) -> Result<f64, ModelError> {
        let squares = self.residuals_ml(at)?.map(|residual_ml| residual_ml * residual_ml);
        Ok(sqrt(squares.sum::<f64>() / (self.doses.len() - PARAMETERS) as f64))
    }

    /// Returns the smallest sum of squares, from the best of zeros all over a pitch: the sum has other minima
    /// in the zero.
    ///
    /// # Errors
    ///
    /// [`CalibrationError::Undetermined`] if the search does not end.
    pub(super) fn search(&self) -> Result<Found<PARAMETERS>, CalibrationError> {
        let mut best = ([1.0, 1.0, 0.0], f64::INFINITY);
        for n in 0..STARTS {
            let start = [1.0, 1.0, f64::from(n) / f64::from(STARTS) * self.pump.pitch_rad()];
            let sum = self.sum(&start)?;
            if sum < best.1 {
                best = (start, sum);
            }
        }
        self.search_from(best.0)
    }

    /// Returns the nearest minimum downhill.
    ///
    /// # Errors
    ///
    /// [`CalibrationError::Undetermined`] if the search does not end. [`CalibrationError::Model`] if it
    /// ends at pumps that cannot be.
    pub(super) fn search_from(
        &self,
        start: [f64; PARAMETERS],
    ) -> Result<Found<PARAMETERS>, CalibrationError> {
        let found = search(self, start)?;
        if found.converged() {
            return Ok(found);
        }
        let why = match (found.rows.singular(), found.refused) {
            // The search ran into pumps that cannot be: their error says what is wrong.
            (_, Some(error)) => return Err(error.into()),
            (Some(_), None) => "they sweep no pulse",
            (None, None) => "the search did not end; are angles and volumes in their columns?",
        };
        Err(CalibrationError::Undetermined { what: "the zero", why })
    }
}

impl Residuals<PARAMETERS> for Pulse<'_> {
    fn sum(&self, at: &[f64; PARAMETERS]) -> Result<f64, ModelError> {
        Ok(self.residuals(at)?.map(|residual| residual * residual).sum())
    }

    fn rows(&self, at: &[f64; PARAMETERS]) -> Result<Triangle<PARAMETERS>, ModelError> {
        let beside = |n: usize, change: f64| {
            let mut probe = *at;
            probe[n] += change;
            self.residuals(&probe)
        };
        let mut more = [beside(0, PROBE)?, beside(1, PROBE)?, beside(2, PROBE)?];
        let mut less = [beside(0, -PROBE)?, beside(1, -PROBE)?, beside(2, -PROBE)?];
        let mut triangle = Triangle::new();
        for residual in self.residuals(at)? {
            // A residual falls where the model rises.
            let slopes = more.iter_mut().zip(&mut less).map(|(more, less)| {
                more.next().zip(less.next()).map_or(0.0, |(more, less)| (less - more) / (2.0 * PROBE))
            });
            let mut row = [0.0; PARAMETERS];
            row.iter_mut().zip(slopes).for_each(|(cell, slope)| *cell = slope);
            triangle.push(row, residual);
        }
        Ok(triangle)
    }
}
