//! The zero of the angle and the shape of a pulse, from short doses at known start angles.

mod fitted_pulse;
mod pulse;
mod pulse_sureness;
#[cfg(test)]
mod tests;

use libm::sqrt;
use pump_model::Pump;
use pump_model::identification::{Estimate, widening};
use pump_model::units::{degrees, wrap};
use serde::Serialize;

pub use self::fitted_pulse::FittedPulse;
use self::pulse::{ENGAGEMENT, PARAMETERS, Pulse, ROLLER, ZERO};
pub(crate) use self::pulse_sureness::PulseSureness;
use super::expected::Expected;
use super::revolution::Revolution;
use super::short_dose::ShortDose;
use crate::calibration::CalibrationError;

/// Fewest short doses that are fitted.
const NEEDED: usize = 5;

/// Roller volume, engagement angle and zero of a pump by short doses.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[non_exhaustive]
pub struct PhaseFit {
    /// V_r, in mL.
    pub roller_volume_ml: Estimate,
    /// phi, in deg.
    pub engagement_deg: Estimate,
    /// Model angle of the rollers where the record says 0, in deg, within half a pitch either way.
    pub zero_deg: Estimate,
    /// Correlation coefficients of the estimates: V_r with phi, V_r with the zero, phi with the zero.
    pub(crate) correlations: [f64; 3],
    /// Standard deviation of the doses about the fit, in mL.
    pub scatter_ml: f64,
    /// Number of doses less number of parameters.
    pub(crate) degrees_of_freedom: u32,
}

impl PhaseFit {
    /// Fits the doses of `pump`, the pump as it is without calibration, by weighted nonlinear least squares
    /// after Levenberg and Marquardt.
    ///
    /// The volume of a revolution is held, since whole pitches tell it better than any short dose. Its
    /// uncertainty is part of the standard uncertainties, by a second fit to so much more volume. A dose
    /// weighs as a run does in [`Displacement::fit`](super::Displacement::fit).
    ///
    /// # Errors
    ///
    /// [`CalibrationError::TooFew`] with fewer than five doses. [`CalibrationError::Undetermined`] if the
    /// doses scatter too much, or sweep too little of a pulse, for the zero to be found.
    pub(crate) fn of(
        pump: &Pump,
        revolution: Revolution<'_>,
        doses: &[ShortDose],
        expected: &Expected,
    ) -> Result<Self, CalibrationError> {
        if doses.len() < NEEDED {
            return Err(CalibrationError::TooFew { given: doses.len(), of: "short doses", needed: NEEDED });
        }
        let factors = doses.iter().map(|dose| revolution.factor(dose)).collect::<Result<Vec<_>, _>>()?;
        let pulse = Pulse { pump, factors: &factors, tilt: 1.0, doses, expected };
        let found = pulse.search()?;
        let best = found.at;
        let degrees_of_freedom = (doses.len() - PARAMETERS) as u32;
        let variance_ratio = found.sum / f64::from(degrees_of_freedom);
        let covariances = found.rows.covariances().ok_or(undetermined(
            "they do not sweep a pulse; turn a fifth of a pitch from angles all over a pitch",
        ))?;
        // Readings that happen to agree do not make up for doses that say nothing of a pulse.
        if sqrt(covariances[ZERO][ZERO]) > pump.pitch_rad() / 12.0 {
            return Err(undetermined(
                "they sweep too little of a pulse; turn a fifth of a pitch from angles all over a pitch",
            ));
        }
        let tilted = Pulse { tilt: 1.0 + revolution.standard(pump)?, ..pulse }.search_from(best)?.at;
        // The scatter of the doses and the revolution's uncertainty move all three together, each its own way.
        let wide = widening(degrees_of_freedom);
        let covariance = |n: usize, m: usize| {
            let moved = (tilted[n] - best[n]) * (tilted[m] - best[m]);
            wide * wide * variance_ratio * covariances[n][m] + moved
        };
        let standard = |n: usize| sqrt(covariance(n, n));
        let estimate =
            |n: usize, value: f64, unit: f64| Estimate { value, standard: standard(n) }.times(unit);
        let correlation = |n: usize, m: usize| match standard(n) * standard(m) {
            // Doses without any scatter leave nothing to be correlated.
            0.0 => 0.0,
            product => covariance(n, m) / product,
        };
        let pitch_rad = pump.pitch_rad();
        let zero_rad = wrap(best[ZERO] + 0.5 * pitch_rad, pitch_rad) - 0.5 * pitch_rad;
        let roller = pump.roller_volume();
        let fit = Self {
            roller_volume_ml: estimate(ROLLER, best[ROLLER], roller.total_ml()),
            engagement_deg: estimate(ENGAGEMENT, best[ENGAGEMENT], roller.engagement_deg()),
            zero_deg: estimate(ZERO, zero_rad, degrees(1.0)),
            correlations: [
                correlation(ROLLER, ENGAGEMENT),
                correlation(ROLLER, ZERO),
                correlation(ENGAGEMENT, ZERO),
            ],
            scatter_ml: pulse.scatter_ml(&best)?,
            degrees_of_freedom,
        };
        if fit.zero_deg.standard > degrees(pitch_rad) / 12.0 {
            return Err(undetermined(
                "the doses scatter too much, or sweep no pulse, for the zero to be found",
            ));
        }
        Ok(fit)
    }
}

fn undetermined(why: &'static str) -> CalibrationError {
    CalibrationError::Undetermined { what: "roller volume, engagement angle and zero", why }
}
