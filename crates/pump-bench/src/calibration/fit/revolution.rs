//! What is known of the volume of a revolution when short doses are fitted.

use pump_model::{ModelError, Pump};

use super::against_speed::AgainstSpeed;
use super::phase::ShortDose;

/// What is known of the volume of a revolution without looking at short doses.
#[derive(Debug, Clone, Copy)]
pub struct Revolution<'a> {
    /// Weighed, or by the pump file's speed law; none takes the model's volume.
    pub against: Option<AgainstSpeed<'a>>,
    /// Standard uncertainty of what was not weighed, part of the volume.
    pub model_standard: f64,
}

impl Revolution<'_> {
    /// Volume of a revolution over the model's at the speed of a dose.
    pub(super) fn factor(&self, dose: &ShortDose) -> Result<f64, ModelError> {
        let Some(against) = &self.against else { return Ok(1.0) };
        against.factor_at(dose.speed_rpm.unwrap_or(against.typical_rpm()).copysign(dose.turned_deg))
    }

    /// Standard uncertainty of that, part of the volume.
    pub(super) fn standard(&self, pump: &Pump) -> Result<f64, ModelError> {
        match self.against.and_then(|against| against.displacement()) {
            Some(known) => known.standard_at(pump, known.reference_rpm),
            None => Ok(self.model_standard),
        }
    }
}
