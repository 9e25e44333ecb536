//! The correction that a calibration makes to a pump.

use pump_model::{ModelError, Pump};
use serde::{Deserialize, Serialize};

/// The correction that a calibration makes to a pump.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Correction {
    /// Factor of every flow and volume: kappa at the cruise speed.
    pub factor: f64,
    /// Model angle of the rollers at angle 0 of the record, in rad.
    pub zero_rad: f64,
}

impl Default for Correction {
    fn default() -> Self {
        Self::NONE
    }
}

impl Correction {
    /// Correction that changes nothing.
    pub(crate) const NONE: Self = Self { factor: 1.0, zero_rad: 0.0 };

    /// Returns true if the correction changes nothing.
    pub(crate) fn is_none(&self) -> bool {
        *self == Self::NONE
    }

    /// Returns the corrected volume of a turn in mL. `pump` is the uncorrected pump.
    pub(crate) fn volume_ml(&self, pump: &Pump, from_rad: f64, to_rad: f64) -> f64 {
        let curve = pump.outlet_curve();
        self.factor * (curve.volume_ml(to_rad + self.zero_rad) - curve.volume_ml(from_rad + self.zero_rad))
    }

    /// Returns the pump with this correction.
    ///
    /// # Errors
    /// Returns the [`ModelError`] of a factor or an angle that the model refuses.
    pub(crate) fn of(&self, pump: &Pump) -> Result<Pump, ModelError> {
        let shifted = if self.zero_rad == 0.0 { *pump } else { pump.shifted(self.zero_rad)? };
        if self.factor == 1.0 { Ok(shifted) } else { shifted.scaled(self.factor) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_correction_gives_the_volumes_of_the_corrected_pump() {
        let pump = Pump::three_roller();
        let correction = Correction { factor: 1.03, zero_rad: 0.4 };
        let corrected = correction.of(&pump).unwrap();
        for (from_rad, turn_rad) in [(0.0, 0.2), (1.1, 7.0), (-2.0, -0.5)] {
            let curve = corrected.outlet_curve();
            let expected_ml = curve.volume_ml(from_rad + turn_rad) - curve.volume_ml(from_rad);
            assert!((correction.volume_ml(&pump, from_rad, from_rad + turn_rad) - expected_ml).abs() < 1e-12);
        }
        assert_eq!(Correction::default().of(&pump).unwrap(), pump);
    }
}
