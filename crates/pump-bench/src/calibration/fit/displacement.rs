//! The displacement factor: measured over model volume, at one speed, as a line over several or by a law.

#[cfg(test)]
mod bend_tests;
mod fitting;
mod flow;
mod stored;
#[cfg(test)]
mod tests;

use libm::sqrt;
use pump_model::identification::widening;
use pump_model::units::rad_s;
use pump_model::{ModelError, Pump};
use serde::{Deserialize, Serialize};

use super::law_fit::LawFit;
use super::points::SAME_SPEED;
use super::prior::ScatterPrior;
use super::scatter::Scatter;
use super::speed_bend::SpeedBend;
use crate::displacement::DisplacementLaw;
use crate::numbers::significant;

/// Displacement factor of weighed runs: the line kappa(N) = factor + slope (N - reference), by weighted least
/// squares, that line with a bend, or a law with that line beside it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "stored::StoredDisplacement", into = "stored::StoredDisplacement")]
#[non_exhaustive]
pub struct Displacement {
    /// Weighted mean speed of the runs, in r/min. Factor and slope are independent there.
    pub reference_rpm: f64,
    /// Measured over model volume at the reference speed.
    pub factor: f64,
    /// Standard error of the factor, from the scatter of the runs.
    pub factor_standard: f64,
    /// Change of the factor with the speed, in min/r; 0 with one speed.
    pub slope_per_rpm: f64,
    /// Standard error of the slope, in min/r; 0 with one speed.
    pub slope_standard_per_rpm: f64,
    /// Bend over the speed, if the runs ask for one.
    pub(crate) bend: Option<SpeedBend>,
    /// Scatter of the runs, about the law if that was fitted.
    pub scatter: Scatter,
    /// Prior that stands beside the scatter, if the runs are weighed doses of a pump whose scatter nobody measured.
    pub prior: Option<ScatterPrior>,
    /// Distance of the means at three speeds or more, four if kappa is bent, from the fit beyond the scatter,
    /// RMS, as a part of the volume.
    pub lack_of_fit: f64,
    /// Standard uncertainty that no mean reduces, as a part of the volume: that of the readings, and of start angles
    /// between bounds.
    pub reading: f64,
    /// Speeds of the runs, in r/min, rising.
    pub speeds_rpm: Vec<f64>,
    /// Numbers of the runs, from 1, that lie far from the line or law. They are in the fit.
    pub outliers: Vec<usize>,
    /// Law of volume against speed, if that was fitted.
    pub law: Option<LawFit>,
}

impl Displacement {
    /// Returns kappa of the line, with its bend, at a speed in r/min.
    pub(crate) fn kappa_at(&self, rpm: f64) -> f64 {
        let x_rpm = rpm - self.reference_rpm;
        let line = self.factor + self.slope_per_rpm * x_rpm;
        self.bend.map_or(line, |bend| line + bend.at(x_rpm))
    }

    /// Returns kappa of `base`, the pump as it is without this calibration, at a speed in r/min, negative in
    /// reverse.
    ///
    /// # Errors
    ///
    /// [`ModelError`] where the law cannot be computed for this pump and speed.
    pub fn factor_at(&self, base: &Pump, rpm: f64) -> Result<f64, ModelError> {
        match &self.law {
            Some(fit) => fit.factor_at(base, rad_s(rpm)),
            None => Ok(self.kappa_at(rpm.abs())),
        }
    }

    /// Returns the standard uncertainty of kappa at a speed in r/min, widened so that twice it covers 95 %
    /// whatever the number of runs.
    ///
    /// # Errors
    ///
    /// [`ModelError`] where the law cannot be computed for this pump and speed.
    pub fn standard_at(&self, base: &Pump, rpm: f64) -> Result<f64, ModelError> {
        let x_rpm = rpm.abs() - self.reference_rpm;
        let [factor, slope] = match &self.law {
            Some(fit) => fit.standards_at(base, rad_s(rpm))?,
            None => [self.factor_standard, self.slope_standard_per_rpm * x_rpm],
        };
        let bend = self.bend.map_or(0.0, |bend| bend.standard_at(x_rpm));
        let scattered = sqrt(factor * factor + slope * slope + bend * bend);
        let errors = self.widening() * scattered;
        let reading = self.factor * self.reading;
        Ok(sqrt(errors * errors + reading * reading))
    }

    /// Returns the widening of standard errors: Student's t over 2, of the prior too if there is one.
    fn widening(&self) -> f64 {
        let of_scatter = || widening(self.scatter.degrees_of_freedom());
        self.prior.map_or_else(of_scatter, |prior| prior.growth())
    }

    /// Returns the standard deviation of repeated runs as a part of the volume, widened as the runs are few. It is 0
    /// if they do not show it. Beside a prior it is what the runs add to that.
    pub(crate) fn repeatability(&self) -> f64 {
        let widened = |standard| widening(self.scatter.degrees_of_freedom()) * standard;
        let of_scatter = || self.scatter.standard().map_or(0.0, widened);
        self.prior.map_or_else(of_scatter, |prior| prior.shown_standard())
    }

    /// Returns this displacement as one more dose, weighed like the others, is expected to leave it. `None` without a
    /// prior, or at several speeds.
    pub(crate) fn after_one_more(&self) -> Option<Self> {
        let now = self.prior.filter(|_| !self.is_line())?;
        let prior = now.after_one_more();
        let fewer = sqrt(f64::from(now.weighed) / f64::from(prior.weighed));
        let error = if now.error_of_one() > 0.0 { prior.error_of_one() / now.error_of_one() } else { 1.0 };
        Some(Self {
            factor_standard: error * fewer * self.factor_standard,
            prior: Some(prior),
            ..self.clone()
        })
    }

    /// Returns the standard uncertainty of kappa at a speed of the runs in r/min: [`Self::standard_at`] with the
    /// lack of fit.
    ///
    /// # Errors
    ///
    /// [`ModelError`] where the law cannot be computed for this pump and speed.
    pub fn whole_standard_at(&self, base: &Pump, rpm: f64) -> Result<f64, ModelError> {
        let standard = self.standard_at(base, rpm)?;
        let lack_of_fit = self.factor * self.lack_of_fit;
        Ok(sqrt(standard * standard + lack_of_fit * lack_of_fit))
    }

    /// Returns [`Self::whole_standard_at`] as a part of the volume.
    ///
    /// # Errors
    ///
    /// [`ModelError`] where the law cannot be computed for this pump and speed.
    pub(crate) fn whole_part_at(&self, base: &Pump, rpm: f64) -> Result<f64, ModelError> {
        Ok(self.whole_standard_at(base, rpm)? / self.factor_at(base, rpm)?)
    }

    /// Returns the standard uncertainty of the bend, in min²/r², widened as that of kappa; 0 without a bend.
    pub(crate) fn bend_standard_per_rpm2(&self) -> f64 {
        self.widening() * self.bend.map_or(0.0, |bend| bend.standard_per_rpm2)
    }

    /// Returns the slowest and the fastest speed of a dose, in r/min: those of the runs, but for a difference
    /// at which speeds are the same.
    fn dose_range_rpm(&self) -> [f64; 2] {
        let (least_rpm, most_rpm) = self.range_rpm();
        [least_rpm * (1.0 - SAME_SPEED), most_rpm * (1.0 + SAME_SPEED)]
    }

    /// Returns the law that was fitted, over the speeds that it covers.
    pub(super) fn displacement_law(&self) -> Option<DisplacementLaw> {
        Some(self.law.as_ref()?.between(self.dose_range_rpm()))
    }

    /// True if kappa was weighed at several speeds, and so holds between them.
    pub(crate) fn is_line(&self) -> bool {
        self.speeds_rpm.len() > 1
    }

    /// Returns the slowest and the fastest speed, in r/min.
    pub(crate) fn range_rpm(&self) -> (f64, f64) {
        let ends = (self.speeds_rpm.first(), self.speeds_rpm.last());
        (ends.0.copied().unwrap_or(self.reference_rpm), ends.1.copied().unwrap_or(self.reference_rpm))
    }

    /// Returns the distance of a speed to the nearest speed of the runs, in r/min; 0 at one of them.
    pub(crate) fn distance_rpm(&self, rpm: f64) -> f64 {
        let nearest = self.speeds_rpm.iter().map(|speed| (speed - rpm).abs()).fold(f64::INFINITY, f64::min);
        if nearest <= SAME_SPEED * rpm { 0.0 } else { nearest }
    }

    /// True if a dose may cruise at this speed, in r/min. A line holds within its speeds; a calibration at
    /// one speed is used at every speed, with a warning.
    pub(crate) fn covers(&self, rpm: f64) -> bool {
        let [least_rpm, most_rpm] = self.dose_range_rpm();
        !self.is_line() || (least_rpm..=most_rpm).contains(&rpm)
    }

    /// Returns the warning of a flow over time whose largest flow needs a speed in r/min that was not weighed.
    pub(crate) fn peak_warning(&self, version: u32, peak_rpm: f64) -> Option<String> {
        let (least_rpm, most_rpm) = self.range_rpm();
        if peak_rpm <= most_rpm * (1.0 + SAME_SPEED) {
            return None;
        }
        let [least, most, peak] = [least_rpm, most_rpm, peak_rpm].map(|speed| significant(speed, 5));
        let speeds =
            if self.is_line() { format!("{least} to {most} r/min") } else { format!("{most} r/min alone") };
        Some(format!(
            "calibration {version} was made at {speeds}, and this flow goes up to {peak} r/min; the uncertainty \
             does not say what that adds; calibrate up to that speed"
        ))
    }
}
