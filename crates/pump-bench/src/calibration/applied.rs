//! Effect of a calibration, or of the pump file's law of displacement, on a dose at its cruise speed.

use libm::sqrt;

use super::fit::{Displacement, PulseSureness, ScatterPrior};
use crate::displacement::Correction;
use crate::numbers::significant;

/// Effect of a calibration, the pump file's law, or both on a dose at its cruise speed.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Applied {
    /// Calibration in use; `None` of the law alone.
    pub(crate) calibration: Option<Made>,
    /// Correction of the pump.
    pub(crate) correction: Correction,
    /// Source of the displacement, with its uncertainty.
    pub(crate) basis: Basis,
    /// Standard uncertainty of the zero, in rad.
    pub(crate) zero_standard_rad: f64,
    /// Uncertainty of a pulse that short doses found, the zero's among it.
    pub(crate) pulse: Option<PulseSureness>,
    /// Turns of the runs that were weighed.
    pub(crate) turns: Vec<WeighedTurn>,
    /// Warning of a speed at which nothing was weighed, for a dose whose uncertainty it widens notably.
    pub(crate) unweighed_speed: Option<String>,
}

/// Turn of a run that was weighed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct WeighedTurn {
    /// Angle of the rollers at the start, in rad of the record. `None` if whole pitches were turned from anywhere.
    pub(crate) start_rad: Option<f64>,
    /// Distance of the true angle at the start from `start_rad`, in rad, at most.
    pub(crate) half_width_rad: f64,
    /// Angle that the rotor turned, in rad; negative in reverse.
    pub(crate) turned_rad: f64,
}

/// Number, date and fluid of a calibration, and the motor's steps.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Made {
    /// Number of the calibration.
    pub(crate) version: u32,
    /// Date at which the calibration was made, UTC.
    pub(crate) date: String,
    /// Name of the fluid that was weighed.
    pub(crate) fluid: String,
    /// Mean temperature of that fluid, in °C.
    pub(crate) temperature_degc: f64,
    /// Motor steps per revolution of the head, as the pump file stated them. `None` in one of an early version.
    pub(crate) steps_per_rev: Option<f64>,
    /// Rollers of the head and bore of its tube in words, as the pump file stated them. `None` in one of an early
    /// version.
    pub(crate) head: Option<String>,
}

/// Source of the displacement of a dose, with its uncertainty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Basis {
    /// The model's displacement, with the pump file's uncertainty of the model.
    Model,
    /// A displacement that was weighed.
    Weighed(Sureness),
    /// The displacement by the pump file's law, with its standard uncertainty as a part of the volume.
    Law(f64),
}

/// Uncertainty of a displacement that was weighed: standard uncertainties as parts of the volume.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Sureness {
    /// Share of the factor at this speed: scatter of the runs, and the readings.
    pub(crate) factor: f64,
    /// Share of the volume's dependence on the speed beyond what the runs show.
    pub(crate) speed_dependence: f64,
    /// Standard deviation of the runs, widened as they are few; 0 if they do not show it.
    pub(crate) repeatability: f64,
    /// Volume of a run, in mL: the largest of all; 0 if the runs do not show their scatter.
    pub(crate) run_ml: f64,
    /// Prior that the pump file's scatter counts by. `None` if the runs or the file show the scatter.
    pub(crate) prior: Option<ScatterPrior>,
    /// Temperature of the fluid of the dose less that of the runs, in °C.
    pub(crate) warmer_degc: f64,
}

impl Applied {
    /// Returns the uncertainty of the displacement if it was weighed.
    pub(crate) fn sureness(&self) -> Option<Sureness> {
        match self.basis {
            Basis::Weighed(sureness) => Some(sureness),
            Basis::Model | Basis::Law(_) => None,
        }
    }

    /// Returns the standard uncertainty of the pump file's law, as a part of the volume, if the
    /// displacement is the law's.
    pub(crate) fn law_standard(&self) -> Option<f64> {
        match self.basis {
            Basis::Law(standard) => Some(standard),
            Basis::Model | Basis::Weighed(_) => None,
        }
    }
}

impl Sureness {
    /// Returns the warning of a dose at a speed in r/min at which nothing was weighed.
    pub(crate) fn warning(&self, version: u32, calibrated: &Displacement, rpm: f64) -> Option<String> {
        let percent = 100.0 * self.speed_dependence;
        (calibrated.speeds_rpm.len() < 3 && percent > 0.0).then(|| {
            let speeds = calibrated.speeds_rpm.iter().map(|speed| significant(*speed, 5));
            format!(
                "calibration {version} was made at {} r/min alone, and this dose cruises at {} r/min: {percent:.2} \
                 % of the volume is added to the uncertainty for that; calibrate at three speeds or more",
                speeds.collect::<Vec<_>>().join(" and "),
                significant(rpm, 5),
            )
        })
    }

    /// Returns the root of the sum of squares of the shares that are common to all doses at this speed.
    pub(crate) fn common(&self) -> f64 {
        sqrt(self.factor * self.factor + self.speed_dependence * self.speed_dependence)
    }
}
