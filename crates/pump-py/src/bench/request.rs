//! The request of a dose, from Python's keywords.

use pump_bench::calibration::Weighing;
use pump_bench::dosing::RunEnd;
use pump_bench::record::Purpose;
use pump_bench::{DoseRequest, units};
use pyo3::prelude::*;

use crate::argument::{cruise, finish_named, number, optional, quantity, ramps_named, retracted_ml, text};
use crate::dosing::Limits;
use crate::python::errors::value;

/// Keywords of a dose, read from a dict.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(super) struct AskedDose<'py> {
    volume: Option<Bound<'py, PyAny>>,
    rate: Option<Bound<'py, PyAny>>,
    speed: Option<Bound<'py, PyAny>>,
    within: Option<Bound<'py, PyAny>>,
    smooth: bool,
    finish: Option<String>,
    ramps: Option<String>,
    retract: Option<Bound<'py, PyAny>>,
    start_angle_rad: Option<Bound<'py, PyAny>>,
    start_half_width_rad: Bound<'py, PyAny>,
    limits: Option<Py<Limits>>,
    duration: Option<Bound<'py, PyAny>>,
    until_stopped: bool,
    reverse: bool,
}

impl AskedDose<'_> {
    /// Returns true if a time or a stop ends the motion.
    fn is_run(&self) -> bool {
        self.duration.is_some() || self.until_stopped
    }

    /// Returns the request for the fluid and the air of `weighing`.
    pub(super) fn request(&self, purpose: Purpose, weighing: &Weighing<'_>) -> PyResult<DoseRequest> {
        let mut asked = None;
        let volume_ml = match &self.volume {
            Some(volume) => {
                let typed = text("volume", "25mL", volume)?;
                asked = Some(typed);
                let amount = quantity("volume", "25mL", volume, units::dose_amount)?;
                let volume_ml = weighing.amount_ml(amount).map_err(value)?;
                if self.reverse && volume_ml < 0.0 {
                    return Err(value("reverse and a negative volume both mean reverse; give one of them"));
                }
                if self.reverse { -volume_ml } else { volume_ml }
            }
            // A time or a stop ends it, and the sign is the direction.
            None if self.is_run() => {
                if self.reverse {
                    -1.0
                } else {
                    1.0
                }
            }
            // The rest of an unfinished dose: the record has its volume.
            None => 0.0,
        };
        let end = match &self.duration {
            Some(time) => RunEnd::Time { time_s: quantity("duration", "2h", time, units::time_s)? },
            None if self.until_stopped => RunEnd::Stop,
            None => RunEnd::Volume,
        };
        let start_angle_rad = optional("start_angle_rad", self.start_angle_rad.as_ref())?;
        if let Some(angle) = start_angle_rad.filter(|angle| !angle.is_finite()) {
            return Err(value(format_args!("start_angle_rad is {angle}; allowed: a finite angle")));
        }
        let half_width_rad = number("start_half_width_rad", &self.start_half_width_rad)?;
        if !(half_width_rad >= 0.0 && half_width_rad.is_finite()) {
            return Err(value(format_args!(
                "start_half_width_rad is {half_width_rad}; allowed: a finite angle, 0 or more"
            )));
        }
        if half_width_rad > 0.0 && start_angle_rad.is_none() {
            return Err(value(format_args!(
                "start_half_width_rad is {half_width_rad} without a start_angle_rad; give both, or neither for the \
                 angle on record"
            )));
        }
        let limits = self.limits.as_ref().map_or(Limits::default(), |limits| *limits.get());
        let request = DoseRequest::new(purpose, volume_ml).with_end(end);
        Ok(asked
            .map_or(request, |typed| request.with_asked(typed))
            .with_cruise(cruise(self.rate.as_ref(), self.speed.as_ref(), self.within.as_ref())?)
            .with_smooth(self.smooth)
            .with_finish(self.finish.as_deref().map(finish_named).transpose()?)
            .with_ramps(self.ramps.as_deref().map(ramps_named).transpose()?)
            .with_retraction(retracted_ml(self.retract.as_ref())?)
            .with_pressures(limits.pressures())
            .with_start_angle(start_angle_rad, half_width_rad))
    }
}
