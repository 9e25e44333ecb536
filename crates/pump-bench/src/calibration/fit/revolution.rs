//! The volume of a revolution as it is known when short doses are fitted.

use pump_model::{ModelError, Pump};

use super::against_speed::AgainstSpeed;
use super::short_dose::ShortDose;

/// Volume of a revolution, as it is known without looking at short doses.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Revolution<'a> {
    /// Displacement that was weighed, or that of the pump file's law; `None` takes the model's volume.
    pub(crate) against: Option<AgainstSpeed<'a>>,
    /// Standard uncertainty of a volume that was not weighed, as a part of it.
    pub(crate) model_standard: f64,
}

impl Revolution<'_> {
    /// Returns the volume of a revolution over the model's at the speed of a dose.
    ///
    /// # Errors
    ///
    /// [`ModelError`] where the law cannot be computed for this pump and speed.
    pub(super) fn factor(&self, dose: &ShortDose) -> Result<f64, ModelError> {
        let Some(against) = &self.against else { return Ok(1.0) };
        against.factor_at(dose.speed_rpm.unwrap_or(against.typical_rpm()).copysign(dose.turned_deg))
    }

    /// Returns the standard uncertainty of the volume of a revolution, as a part of it.
    ///
    /// # Errors
    ///
    /// [`ModelError`] where the law cannot be computed for this pump.
    pub(super) fn standard(&self, pump: &Pump) -> Result<f64, ModelError> {
        match self.against.and_then(|against| against.displacement()) {
            Some(known) => known.whole_part_at(pump, known.reference_rpm),
            None => Ok(self.model_standard),
        }
    }
}
