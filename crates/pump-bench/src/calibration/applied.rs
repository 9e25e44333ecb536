//! Effect of a calibration, or of the pump file's speed law, on a dose at its cruise speed.

use pump_model::math::sqrt;

use super::fit::Displacement;
use crate::displacement::Correction;
use crate::numbers::significant;

/// Effect of a calibration, the pump file's speed law, or both on a dose at its cruise speed.
#[derive(Debug, Clone, PartialEq)]
pub struct Applied {
    /// Calibration in use; `None` of the speed law alone.
    pub calibration: Option<Made>,
    /// Correction of the pump.
    pub correction: Correction,
    /// Source of the displacement, with its uncertainty.
    pub basis: Basis,
    /// Standard uncertainty of the zero, in rad.
    pub zero_standard_rad: f64,
}

/// Number and date of a calibration.
#[derive(Debug, Clone, PartialEq)]
pub struct Made {
    /// Number of the calibration.
    pub version: u32,
    /// Date at which the calibration was made, UTC.
    pub date: String,
}

/// Source of the displacement of a dose, with its uncertainty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Basis {
    /// The model's displacement, with the pump file's uncertainty of the model.
    Model,
    /// A displacement that was weighed.
    Weighed(Sureness),
    /// The pump file's speed law, with its standard uncertainty as a part of the volume.
    SpeedLaw(f64),
}

/// Uncertainty of a displacement that was weighed: standard uncertainties as parts of the volume.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sureness {
    /// Share of the factor at this speed: scatter of the runs, and the readings.
    pub factor: f64,
    /// Share of the volume's dependence on the speed beyond what the runs show.
    pub speed_law: f64,
    /// Standard deviation of the runs; 0 if they do not show it.
    pub repeatability: f64,
    /// Temperature of the fluid of the dose less that of the runs, in °C.
    pub warmer_degc: f64,
}

impl Applied {
    /// Returns the uncertainty of the displacement if it was weighed.
    pub fn sureness(&self) -> Option<Sureness> {
        match self.basis {
            Basis::Weighed(sureness) => Some(sureness),
            Basis::Model | Basis::SpeedLaw(_) => None,
        }
    }

    /// Returns the standard uncertainty of the pump file's speed law, as a part of the volume, if the
    /// displacement is the law's.
    pub fn speed_law(&self) -> Option<f64> {
        match self.basis {
            Basis::SpeedLaw(standard) => Some(standard),
            Basis::Model | Basis::Weighed(_) => None,
        }
    }
}

impl Sureness {
    /// Returns the warning of a dose at a speed in r/min at which nothing was weighed.
    pub(crate) fn warning(&self, version: u32, calibrated: &Displacement, rpm: f64) -> Option<String> {
        let percent = 100.0 * self.speed_law;
        (calibrated.speeds_rpm.len() < 3 && percent > 0.0).then(|| {
            let speeds = calibrated.speeds_rpm.iter().map(|speed| significant(*speed, 5));
            format!(
                "calibration {version} was made at {} r/min alone, and this dose cruises at {}: {percent:.2} \
                 % of the volume is added to the uncertainty for that; calibrate at three speeds or more",
                speeds.collect::<Vec<_>>().join(" and "),
                significant(rpm, 5),
            )
        })
    }

    /// Returns the root of the sum of squares of the shares that are common to all doses at this speed.
    pub fn common(&self) -> f64 {
        sqrt(self.factor * self.factor + self.speed_law * self.speed_law)
    }
}
