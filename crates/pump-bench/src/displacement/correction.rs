//! The correction that a calibration makes to a pump.

use pump_model::{ModelError, Pump};
use serde::{Deserialize, Serialize};

use super::pulse::PulseCorrection;

/// The correction that a calibration makes to a pump.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Correction {
    /// Factor of every flow and volume: kappa at the cruise speed.
    pub(crate) factor: f64,
    /// Model angle of the rollers at angle 0 of the record, in rad.
    pub(crate) zero_rad: f64,
    /// Pulse of a roller; `None` leaves the pump's own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) pulse: Option<PulseCorrection>,
}

impl Default for Correction {
    fn default() -> Self {
        Self::NONE
    }
}

impl Correction {
    /// Correction that changes nothing.
    pub(crate) const NONE: Self = Self { factor: 1.0, zero_rad: 0.0, pulse: None };

    /// Returns true if the correction changes nothing.
    pub(crate) fn is_none(&self) -> bool {
        *self == Self::NONE
    }

    /// Returns true if both corrections give the same place in a pitch and the same pulse, so that the
    /// volumes of their turns differ by a factor alone.
    pub(crate) fn shapes_like(&self, other: &Self) -> bool {
        self.zero_rad == other.zero_rad && self.pulse == other.pulse
    }

    /// Returns the uncorrected pump with the pulse of this correction, without its factor and its zero.
    ///
    /// A pump that refuses the pulse keeps its own: the pump file was changed after the correction was
    /// recorded. Volumes on record are then those of the changed pump.
    pub(crate) fn pulsed(&self, pump: &Pump) -> Pump {
        self.pulse.and_then(|pulse| pulse.of(pump).ok()).unwrap_or(*pump)
    }

    /// Returns the corrected volume of a turn in mL. `pulsed` is the pump of [`Self::pulsed`].
    pub(crate) fn volume_ml(&self, pulsed: &Pump, from_rad: f64, to_rad: f64) -> f64 {
        let curve = pulsed.outlet_curve();
        self.factor * (curve.volume_ml(to_rad + self.zero_rad) - curve.volume_ml(from_rad + self.zero_rad))
    }

    /// Returns the pump with this correction.
    ///
    /// # Errors
    /// Returns the [`ModelError`] of a factor or an angle that the model refuses.
    pub(crate) fn of(&self, pump: &Pump) -> Result<Pump, ModelError> {
        let pulsed = self.pulse.map_or(Ok(*pump), |pulse| pulse.of(pump))?;
        let shifted = if self.zero_rad == 0.0 { pulsed } else { pulsed.shifted(self.zero_rad)? };
        if self.factor == 1.0 { Ok(shifted) } else { shifted.scaled(self.factor) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_correction_gives_the_volumes_of_the_corrected_pump() {
        let pump = Pump::three_roller();
        let pulse = PulseCorrection { roller_volume_ml: 2.0, engagement_deg: 52.0 };
        let correction = Correction { factor: 1.03, zero_rad: 0.4, pulse: Some(pulse) };
        let (corrected, pulsed) = (correction.of(&pump).unwrap(), correction.pulsed(&pump));
        for (from_rad, turn_rad) in [(0.0, 0.2), (1.1, 7.0), (-2.0, -0.5)] {
            let curve = corrected.outlet_curve();
            let expected_ml = curve.volume_ml(from_rad + turn_rad) - curve.volume_ml(from_rad);
            assert!(
                (correction.volume_ml(&pulsed, from_rad, from_rad + turn_rad) - expected_ml).abs() < 1e-12
            );
        }
        assert_eq!(Correction::default().of(&pump).unwrap(), pump);
    }
}
