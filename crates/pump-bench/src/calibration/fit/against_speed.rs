//! Displacement against speed, kappa(N): a line that was fitted, or a speed law, fitted or of the pump file.

use pump_model::math::{rad_s, rpm};
use pump_model::{ModelError, Pump};

use super::Displacement;
use crate::displacement::RangedLaw;

/// What every flow and volume of a pump is multiplied by at a cruise speed.
#[derive(Debug, Clone, Copy)]
pub struct AgainstSpeed<'a> {
    /// What was weighed; none if the pump file's law says it.
    displacement: Option<&'a Displacement>,
    /// None of a line.
    law: Option<RangedLaw>,
    base: &'a Pump,
}

impl<'a> AgainstSpeed<'a> {
    /// What was weighed, which takes the place of the pump file's law, or else that law; none without either. `base` is the
    /// pump as it is without both, counted from its own zero.
    pub fn of(
        displacement: Option<&'a Displacement>,
        law: Option<RangedLaw>,
        base: &'a Pump,
    ) -> Option<Self> {
        let law = displacement.map_or(law, Displacement::law);
        (displacement.is_some() || law.is_some()).then_some(Self { displacement, law, base })
    }

    /// The same with flows of the law up to this speed alone, r/min, if it holds for a slower one.
    pub(crate) fn up_to(self, most_rpm: f64) -> Self {
        Self { law: self.law.map(|law| law.up_to(most_rpm)), ..self }
    }

    /// What was weighed; none if the pump file's law says it.
    pub fn displacement(&self) -> Option<&'a Displacement> {
        self.displacement
    }

    /// The law; none of a line.
    pub fn law(&self) -> Option<&RangedLaw> {
        self.law.as_ref()
    }

    /// kappa at a speed in r/min, negative in reverse. A line is the same both ways.
    pub fn factor_at(&self, speed_rpm: f64) -> Result<f64, ModelError> {
        match (&self.law, self.displacement) {
            (Some(law), _) => law.law.factor(self.base, rad_s(speed_rpm)),
            (None, Some(line)) => Ok(line.line_at(speed_rpm.abs())),
            (None, None) => Ok(1.0),
        }
    }

    /// Slowest and fastest speed that a dose may have, r/min; none if it is used at all of them, as what was weighed at one.
    pub fn range_rpm(&self) -> Option<(f64, f64)> {
        match self.displacement {
            Some(found) => found.is_line().then(|| found.range_rpm()),
            None => self.law.map(|law| (law.least_rpm, law.most_rpm)),
        }
    }

    /// Whether a dose may cruise at this speed, r/min, either way.
    pub fn covers(&self, speed_rpm: f64) -> bool {
        match (self.displacement, &self.law) {
            (Some(found), _) => found.covers(speed_rpm.abs()),
            (None, Some(law)) => law.covers(speed_rpm),
            (None, None) => true,
        }
    }

    /// A speed within the range, r/min, where a search may begin.
    pub fn typical_rpm(&self) -> f64 {
        match (self.displacement, self.law) {
            (Some(found), _) => found.reference_rpm,
            (None, Some(law)) => 0.5 * (law.least_rpm + law.most_rpm),
            (None, None) => 0.0,
        }
    }

    /// The slowest speed, r/min, whose mean flow is `flow_ml_s`, positive; none if there is none. That of a line may lie
    /// beyond its range.
    pub fn speed_for_flow(&self, flow_ml_s: f64, reverse: bool) -> Result<Option<f64>, ModelError> {
        match (&self.law, self.displacement) {
            (Some(law), _) => Ok(law.flow(self.base, reverse)?.speed_rad_s(flow_ml_s)?.map(rpm)),
            (None, Some(line)) => Ok(line.speed_for_flow(self.base.revolution_ml(), flow_ml_s)),
            (None, None) => Ok(Some(60.0 * flow_ml_s / self.base.revolution_ml())),
        }
    }

    /// Mean flow at the slowest speed of the range and the largest within it, mL/s, positive; none without a range.
    pub fn flows_ml_s(&self, reverse: bool) -> Result<Option<(f64, f64)>, ModelError> {
        let Some((least_rpm, most_rpm)) = self.range_rpm() else { return Ok(None) };
        let direction = if reverse { -1.0 } else { 1.0 };
        let flow_ml_s = |rpm: f64| -> Result<f64, ModelError> {
            Ok(self.factor_at(direction * rpm)? * self.base.revolution_ml() * rpm / 60.0)
        };
        let largest_ml_s = match (&self.law, self.displacement) {
            (Some(law), _) => law.flow(self.base, reverse)?.largest()?.0,
            // kappa(N) N is a parabola.
            (None, Some(line)) => {
                let top_rpm = -line.line_at(0.0) / (2.0 * line.slope_per_rpm);
                let inside = (least_rpm..=most_rpm).contains(&top_rpm);
                flow_ml_s(most_rpm)?.max(flow_ml_s(if inside { top_rpm } else { least_rpm })?)
            }
            (None, None) => flow_ml_s(most_rpm)?,
        };
        Ok(Some((flow_ml_s(least_rpm)?, largest_ml_s)))
    }
}
