//! The pulse of a roller that short doses found, in the place of the pump file's.

use pump_model::{ModelError, Pump};
use serde::{Deserialize, Serialize};

/// Roller volume and engagement angle that short doses found. They take the place of the pump file's.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PulseCorrection {
    /// Roller volume V_r, in mL, before all volumes are scaled to keep that of a revolution.
    pub(crate) roller_volume_ml: f64,
    /// Engagement angle phi, in deg.
    pub(crate) engagement_deg: f64,
}

impl PulseCorrection {
    /// Returns `pump` with this pulse, with the shape of its own curve. A revolution delivers what it did: whole
    /// pitches tell that volume better than any short dose.
    ///
    /// # Errors
    ///
    /// [`ModelError`] of a pulse that this pump cannot have.
    pub(crate) fn of(&self, pump: &Pump) -> Result<Pump, ModelError> {
        let roller =
            pump.roller_volume().scaled_to(self.roller_volume_ml)?.stretched_to(self.engagement_deg)?;
        let pulsed = pump.with_roller_volume(roller)?;
        pulsed.scaled(pump.revolution_ml() / pulsed.revolution_ml())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn another_pulse_leaves_the_revolution_as_it_was() {
        let pump = Pump::three_roller();
        let pulse = PulseCorrection { roller_volume_ml: 2.2, engagement_deg: 48.0 };
        let pulsed = pulse.of(&pump).unwrap();
        assert!((pulsed.revolution_ml() / pump.revolution_ml() - 1.0).abs() < 1e-14);
        assert!((pulsed.roller_volume().engagement_deg() - 48.0).abs() < 1e-12);
        // V_nom - NU V_r = 27.63489 - 3 * 2.2 mL a revolution without the scale.
        let scale = 21.318_49 / (27.634_89 - 6.6);
        assert!((pulsed.roller_volume().total_ml() / (2.2 * scale) - 1.0).abs() < 1e-6);
        assert!(PulseCorrection { roller_volume_ml: 30.0, ..pulse }.of(&pump).is_err());
        assert!(PulseCorrection { engagement_deg: f64::NAN, ..pulse }.of(&pump).is_err());
    }
}
