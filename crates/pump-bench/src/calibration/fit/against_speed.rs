//! Displacement against speed, kappa(N): a line that was fitted, or a speed law, fitted or of the pump file.

use pump_model::math::{rad_s, rpm};
use pump_model::{ModelError, Pump};

use super::Displacement;
use crate::displacement::RangedLaw;

/// Displacement factor of a pump against its cruise speed. Every flow and volume of the pump is multiplied by
/// it.
#[derive(Debug, Clone, Copy)]
pub struct AgainstSpeed<'a> {
    known: Known<'a>,
    base: &'a Pump,
}

/// Source of the displacement.
#[derive(Debug, Clone, Copy)]
enum Known<'a> {
    /// Line through weighed runs, or their mean at one speed.
    Line(&'a Displacement),
    /// Speed law that was fitted to weighed runs.
    Fitted(&'a Displacement, RangedLaw),
    /// Speed law of the pump file.
    Given(RangedLaw),
}

impl<'a> AgainstSpeed<'a> {
    /// Returns the displacement that was weighed, or else that of the pump file's `law`. Returns `None`
    /// without either. `base` is the pump as it is without both, counted from its own zero.
    pub fn of(
        displacement: Option<&'a Displacement>,
        law: Option<RangedLaw>,
        base: &'a Pump,
    ) -> Option<Self> {
        let known = match displacement {
            Some(found) => found.law().map_or(Known::Line(found), |law| Known::Fitted(found, law)),
            None => Known::Given(law?),
        };
        Some(Self { known, base })
    }

    /// Limits the flows of a law to speeds up to `most_rpm`, in r/min, if the law holds for a slower one.
    pub(crate) fn up_to(self, most_rpm: f64) -> Self {
        let known = match self.known {
            Known::Line(found) => Known::Line(found),
            Known::Fitted(found, law) => Known::Fitted(found, law.up_to(most_rpm)),
            Known::Given(law) => Known::Given(law.up_to(most_rpm)),
        };
        Self { known, ..self }
    }

    /// Returns the displacement that was weighed, or `None` of the pump file's law.
    pub fn displacement(&self) -> Option<&'a Displacement> {
        match self.known {
            Known::Line(found) | Known::Fitted(found, _) => Some(found),
            Known::Given(_) => None,
        }
    }

    /// Returns the pump file's law, or `None` of a displacement that was weighed.
    pub fn given_law(&self) -> Option<&RangedLaw> {
        match &self.known {
            Known::Line(_) | Known::Fitted(..) => None,
            Known::Given(law) => Some(law),
        }
    }

    /// Returns kappa at a speed in r/min, negative in reverse. kappa of a line is the same both ways.
    ///
    /// # Errors
    ///
    /// [`ModelError`] where the speed law cannot be computed for this pump and speed.
    pub fn factor_at(&self, speed_rpm: f64) -> Result<f64, ModelError> {
        match &self.known {
            Known::Line(line) => Ok(line.line_at(speed_rpm.abs())),
            Known::Fitted(_, law) | Known::Given(law) => law.law.factor(self.base, rad_s(speed_rpm)),
        }
    }

    /// Returns the slowest and the fastest speed that a dose may have, in r/min. Returns `None` if the
    /// displacement is used at every speed, as one that was weighed at one speed is.
    pub fn range_rpm(&self) -> Option<(f64, f64)> {
        match &self.known {
            Known::Line(found) | Known::Fitted(found, _) => found.is_line().then(|| found.range_rpm()),
            Known::Given(law) => Some((law.least_rpm, law.most_rpm)),
        }
    }

    /// True if a dose may cruise at this speed, in r/min, either way.
    pub fn covers(&self, speed_rpm: f64) -> bool {
        match &self.known {
            Known::Line(found) | Known::Fitted(found, _) => found.covers(speed_rpm.abs()),
            Known::Given(law) => law.covers(speed_rpm),
        }
    }

    /// Returns a speed within the range, in r/min, where a search may begin.
    pub fn typical_rpm(&self) -> f64 {
        match &self.known {
            Known::Line(found) | Known::Fitted(found, _) => found.reference_rpm,
            Known::Given(law) => 0.5 * (law.least_rpm + law.most_rpm),
        }
    }

    /// Returns the slowest speed, in r/min, whose mean flow is `flow_ml_s`, positive, or `None` if there is
    /// none. The speed of a line may lie beyond its range.
    ///
    /// # Errors
    ///
    /// [`ModelError`] where the speed law cannot be computed for this pump.
    pub fn speed_for_flow(&self, flow_ml_s: f64, reverse: bool) -> Result<Option<f64>, ModelError> {
        match &self.known {
            Known::Line(line) => Ok(line.speed_for_flow(self.base.revolution_ml(), flow_ml_s)),
            Known::Fitted(_, law) | Known::Given(law) => {
                Ok(law.flow(self.base, reverse)?.speed_rad_s(flow_ml_s)?.map(rpm))
            }
        }
    }

    /// Returns the mean flow at the slowest speed of the range and the largest mean flow within the range, in
    /// mL/s, positive. Returns `None` without a range.
    ///
    /// # Errors
    ///
    /// [`ModelError`] where the speed law cannot be computed for this pump.
    pub fn flows_ml_s(&self, reverse: bool) -> Result<Option<(f64, f64)>, ModelError> {
        let Some((least_rpm, most_rpm)) = self.range_rpm() else { return Ok(None) };
        let direction = if reverse { -1.0 } else { 1.0 };
        let flow_ml_s = |rpm: f64| -> Result<f64, ModelError> {
            Ok(self.factor_at(direction * rpm)? * self.base.revolution_ml() * rpm / 60.0)
        };
        let largest_ml_s = match &self.known {
            // kappa(N) N is a parabola.
            Known::Line(line) => {
                let top_rpm = -line.line_at(0.0) / (2.0 * line.slope_per_rpm);
                let inside = (least_rpm..=most_rpm).contains(&top_rpm);
                flow_ml_s(most_rpm)?.max(flow_ml_s(if inside { top_rpm } else { least_rpm })?)
            }
            Known::Fitted(_, law) | Known::Given(law) => law.flow(self.base, reverse)?.largest()?.0,
        };
        Ok(Some((flow_ml_s(least_rpm)?, largest_ml_s)))
    }
}
