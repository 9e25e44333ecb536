//! The request for a dose.

mod run_bound;
mod run_end;

use pump_ctl::plan::{Cruise, Finish, PressureLimits, Ramps};

pub use run_bound::RunBound;
pub use run_end::RunEnd;

use crate::record::{DoseTerms, Purpose, ShortText};

/// Request for a dose.
///
/// ```
/// use pump_bench::DoseRequest;
/// use pump_ctl::plan::{Cruise, Finish};
///
/// let request = DoseRequest::dose(25.0).with_cruise(Cruise::Flow { ml_s: 5.0 }).with_finish(Finish::LowFlow);
/// assert_eq!(request.volume_ml, 25.0);
/// assert_eq!(request.finish, Some(Finish::LowFlow));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct DoseRequest {
    /// Purpose of the motion.
    pub purpose: Purpose,
    /// Volume, in mL. Negative in reverse, never zero. With another end than the volume its sign alone counts.
    pub volume_ml: f64,
    /// Event that ends the motion.
    pub end: RunEnd,
    /// Volume as it was typed, for the report and the log. `None` if a program gives a number.
    pub asked: Option<ShortText>,
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
        Self::new(Purpose::Dose, volume_ml)
    }

    /// Requests a motion for a purpose, with the pump file's defaults.
    pub fn new(purpose: Purpose, volume_ml: f64) -> Self {
        Self {
            purpose,
            volume_ml,
            end: RunEnd::Volume,
            asked: None,
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

    /// Returns the request with another end than its volume.
    #[must_use]
    pub fn with_end(self, end: RunEnd) -> Self {
        Self { end, ..self }
    }

    /// Returns the request with its volume as it was typed, for the report and the log.
    #[must_use]
    pub fn with_asked(self, asked: &str) -> Self {
        Self { asked: Some(ShortText::new(asked)), ..self }
    }

    /// Returns the request with a cruise. `None` takes the pump file's default rate.
    #[must_use]
    pub fn with_cruise(self, cruise: impl Into<Option<Cruise>>) -> Self {
        Self { cruise: cruise.into(), ..self }
    }

    /// Returns the request with a speed that follows the rollers' angle for a smooth flow, or without.
    #[must_use]
    pub fn with_smooth(self, smooth: bool) -> Self {
        Self { smooth, ..self }
    }

    /// Returns the request with the position in a pitch where the dose may end. `None` lets a dose end anywhere, and
    /// the rest of a dose where the whole dose was to end.
    #[must_use]
    pub fn with_finish(self, finish: impl Into<Option<Finish>>) -> Self {
        Self { finish: finish.into(), ..self }
    }

    /// Returns the request with the angle at the start, in rad, which is known within `half_width_rad` on either
    /// side. `None` takes the recorded angle.
    #[must_use]
    pub fn with_start_angle(self, angle_rad: impl Into<Option<f64>>, half_width_rad: f64) -> Self {
        Self { start_angle_rad: angle_rad.into(), start_half_width_rad: half_width_rad, ..self }
    }

    /// Returns the request with a volume to suck back after the dose, in mL, positive. `None` sucks nothing back.
    #[must_use]
    pub fn with_retraction(self, retract_ml: impl Into<Option<f64>>) -> Self {
        Self { retract_ml: retract_ml.into(), ..self }
    }

    /// Returns the request with ramps. `None` takes line-aware ramps, or those of a drive that makes its own.
    #[must_use]
    pub fn with_ramps(self, ramps: impl Into<Option<Ramps>>) -> Self {
        Self { ramps: ramps.into(), ..self }
    }

    /// Returns the request with pressure limits. The pump file's limits take the place of those left out.
    #[must_use]
    pub fn with_pressures(self, pressures: PressureLimits) -> Self {
        Self { pressures, ..self }
    }

    /// Completes the request for the rest of a dose that was cut off. The terms of the whole dose fill what
    /// the request leaves open. A speed in the request without a smooth flow means a constant speed.
    pub(crate) fn for_rest(self, whole: &DoseTerms) -> Self {
        let finish = if whole.low_flow { Finish::LowFlow } else { Finish::Any };
        Self {
            cruise: self.cruise.or(whole.cruise()),
            end: if whole.until_stopped { RunEnd::Stop } else { RunEnd::Volume },
            smooth: self.smooth || (whole.smooth && self.cruise.is_none()),
            finish: self.finish.or(Some(finish)),
            ramps: self.ramps.or(whole.ramps),
            pressures: self.pressures.or(whole.pressures()),
            ..self
        }
    }
}
