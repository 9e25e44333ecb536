//! Displacement against speed, kappa(N): a line that was fitted, or a law, fitted or of the pump file.

use pump_model::units::{rad_s, rpm};
use pump_model::{ModelError, Pump};

use super::Displacement;
use crate::displacement::{DisplacementLaw, SpeedDependentPump};

/// Displacement factor of a pump against its cruise speed. Every flow and volume of the pump is multiplied by
/// it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct AgainstSpeed<'a> {
    known: DisplacementSource<'a>,
    base: &'a Pump,
}

/// Source of the displacement.
#[derive(Debug, Clone, Copy)]
enum DisplacementSource<'a> {
    /// Line through weighed runs, or their mean at one speed.
    Line(&'a Displacement),
    /// Law that was fitted to weighed runs.
    Fitted(&'a Displacement, DisplacementLaw),
    /// Law of the pump file.
    Given(DisplacementLaw),
}

impl<'a> AgainstSpeed<'a> {
    /// Returns the displacement that was weighed, or else that of the pump's own law. Returns `None` without
    /// either. `pump` is counted from its own zero.
    pub(crate) fn of(displacement: Option<&'a Displacement>, pump: &'a SpeedDependentPump) -> Option<Self> {
        let known = match displacement {
            Some(found) => found
                .displacement_law()
                .map_or(DisplacementSource::Line(found), |law| DisplacementSource::Fitted(found, law)),
            None => DisplacementSource::Given(*pump.law()?),
        };
        Some(Self { known, base: pump.base() })
    }

    /// Limits the flows of a law to speeds up to `most_rpm`, in r/min, if the law holds for a slower one.
    pub(crate) fn up_to(self, most_rpm: f64) -> Self {
        let known = match self.known {
            DisplacementSource::Line(found) => DisplacementSource::Line(found),
            DisplacementSource::Fitted(found, law) => DisplacementSource::Fitted(found, law.up_to(most_rpm)),
            DisplacementSource::Given(law) => DisplacementSource::Given(law.up_to(most_rpm)),
        };
        Self { known, ..self }
    }

    /// Returns the displacement that was weighed, or `None` of the pump file's law.
    pub(crate) fn displacement(&self) -> Option<&'a Displacement> {
        match self.known {
            DisplacementSource::Line(found) | DisplacementSource::Fitted(found, _) => Some(found),
            DisplacementSource::Given(_) => None,
        }
    }

    /// Returns the pump file's law, or `None` of a displacement that was weighed.
    pub(crate) fn given_law(&self) -> Option<&DisplacementLaw> {
        match &self.known {
            DisplacementSource::Line(_) | DisplacementSource::Fitted(..) => None,
            DisplacementSource::Given(law) => Some(law),
        }
    }

    /// Returns kappa at a speed in r/min, negative in reverse. kappa of a line is the same both ways.
    ///
    /// # Errors
    ///
    /// [`ModelError`] where the law cannot be computed for this pump and speed.
    pub(crate) fn factor_at(&self, speed_rpm: f64) -> Result<f64, ModelError> {
        match &self.known {
            DisplacementSource::Line(line) => Ok(line.kappa_at(speed_rpm.abs())),
            DisplacementSource::Fitted(_, law) | DisplacementSource::Given(law) => {
                law.factor_at_any(self.base, rad_s(speed_rpm))
            }
        }
    }

    /// Returns the slowest and the fastest speed that a dose may have, in r/min. Returns `None` if the
    /// displacement is used at every speed, as one that was weighed at one speed is.
    pub(crate) fn range_rpm(&self) -> Option<(f64, f64)> {
        match &self.known {
            DisplacementSource::Line(found) | DisplacementSource::Fitted(found, _) => {
                found.is_line().then(|| found.range_rpm())
            }
            DisplacementSource::Given(law) => Some(law.range_rpm()),
        }
    }

    /// True if a dose may cruise at this speed, in r/min, either way.
    pub(crate) fn covers(&self, speed_rpm: f64) -> bool {
        match &self.known {
            DisplacementSource::Line(found) | DisplacementSource::Fitted(found, _) => {
                found.covers(speed_rpm.abs())
            }
            DisplacementSource::Given(law) => law.covers(speed_rpm),
        }
    }

    /// Returns a speed within the range, in r/min, where a search may begin.
    pub(crate) fn typical_rpm(&self) -> f64 {
        match &self.known {
            DisplacementSource::Line(found) | DisplacementSource::Fitted(found, _) => found.reference_rpm,
            DisplacementSource::Given(law) => {
                let (least_rpm, most_rpm) = law.range_rpm();
                0.5 * (least_rpm + most_rpm)
            }
        }
    }

    /// Returns the slowest speed, in r/min, whose mean flow is `flow_ml_s`, positive, or `None` if there is
    /// none. The speed of a line may lie beyond its range.
    ///
    /// # Errors
    ///
    /// [`ModelError`] where the law cannot be computed for this pump.
    pub(crate) fn speed_for_flow(&self, flow_ml_s: f64, reverse: bool) -> Result<Option<f64>, ModelError> {
        match &self.known {
            DisplacementSource::Line(line) => Ok(line.speed_for_flow(self.base.revolution_ml(), flow_ml_s)),
            DisplacementSource::Fitted(_, law) | DisplacementSource::Given(law) => {
                Ok(law.speed_for_flow(self.base, flow_ml_s, reverse)?.map(rpm))
            }
        }
    }

    /// Returns the mean flow at the slowest speed of the range and the largest mean flow within the range, in
    /// mL/s, positive. Returns `None` without a range.
    ///
    /// # Errors
    ///
    /// [`ModelError`] where the law cannot be computed for this pump.
    pub(crate) fn flows_ml_s(&self, reverse: bool) -> Result<Option<(f64, f64)>, ModelError> {
        let Some((least_rpm, most_rpm)) = self.range_rpm() else { return Ok(None) };
        let direction = if reverse { -1.0 } else { 1.0 };
        let flow_ml_s = |rpm: f64| -> Result<f64, ModelError> {
            Ok(self.factor_at(direction * rpm)? * self.base.revolution_ml() * rpm / 60.0)
        };
        let largest_ml_s = match &self.known {
            DisplacementSource::Line(line) => flow_ml_s(line.largest_flow_rpm(least_rpm, most_rpm))?,
            DisplacementSource::Fitted(_, law) | DisplacementSource::Given(law) => {
                law.largest_flow_ml_s(self.base, reverse)?
            }
        };
        Ok(Some((flow_ml_s(least_rpm)?, largest_ml_s)))
    }
}
