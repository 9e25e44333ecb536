//! The request for a dose.

use pump_ctl::plan::{Cruise, Finish, PressureLimits, Ramps};

use crate::record::{DoseTerms, Purpose};

/// Request for a dose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DoseRequest {
    /// Purpose of the motion.
    pub purpose: Purpose,
    /// Volume, in mL. Negative in reverse, never zero.
    pub volume_ml: f64,
    /// Cruise of the dose. `None` takes the pump file's default rate.
    pub cruise: Option<Cruise>,
    /// True if the speed follows the rollers' angle for a smooth flow.
    pub smooth: bool,
    /// Position in a pitch where the dose may end. Its retraction may end anywhere. `None` lets the dose end
    /// anywhere, and the rest of a dose where the whole dose was to end.
    pub finish: Option<Finish>,
    /// Angle at the start, in rad. `None` takes the recorded angle.
    pub start_angle_rad: Option<f64>,
    /// Half width of the angle at the start, in rad: the true angle lies within it on either side. It counts where
    /// `start_angle_rad` gives the angle. 0 is an exact angle.
    pub start_half_width_rad: f64,
    /// Volume of the whole dose if this is the rest of one that was cut off, in mL. `None` if this is the
    /// whole.
    pub whole_ml: Option<f64>,
    /// Volume to suck back after the dose, in mL, positive. `None` sucks nothing back.
    pub retract_ml: Option<f64>,
    /// Ramps in which the dose starts and stops. `None` takes line-aware ramps, or those of a drive that makes
    /// its own. The rest of a dose takes those of the whole dose.
    pub ramps: Option<Ramps>,
    /// Pressure limits of the dose. The pump file's limits take the place of those left out.
    pub pressures: PressureLimits,
}

impl DoseRequest {
    /// Requests a dose with the pump file's defaults.
    pub fn dose(volume_ml: f64) -> Self {
        Self {
            purpose: Purpose::Dose,
            volume_ml,
            cruise: None,
            smooth: false,
            finish: None,
            start_angle_rad: None,
            start_half_width_rad: 0.0,
            whole_ml: None,
            retract_ml: None,
            ramps: None,
            pressures: PressureLimits::NONE,
        }
    }

    /// Completes the request for the rest of a dose that was cut off. The terms of the whole dose fill what
    /// the request leaves open. A speed in the request without a smooth flow means a constant speed.
    pub(crate) fn for_rest(self, whole: &DoseTerms) -> Self {
        let finish = if whole.low_flow { Finish::LowFlow } else { Finish::Any };
        Self {
            cruise: self.cruise.or(whole.cruise()),
            smooth: self.smooth || (whole.smooth && self.cruise.is_none()),
            finish: self.finish.or(Some(finish)),
            ramps: self.ramps.or(whole.ramps),
            pressures: self.pressures.or(whole.pressures()),
            ..self
        }
    }
}
