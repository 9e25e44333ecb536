//! Plans of a pump whose displacement depends on the speed. A plan has the displacement of its own cruise
//! speed.

#[cfg(test)]
mod by_law;
mod range;
mod search;
#[cfg(test)]
mod short;
#[cfg(test)]
mod tests;

use pump_ctl::plan::{Cruise, Doser, Limits, Phase, Plan, Request};
use pump_model::units::{radians, rpm};
use pump_model::{ModelError, Pump};

use super::error::DoseError;
use crate::calibration::{AgainstSpeed, Applied, Basis, CalibrationError, Made, Stored};
use crate::displacement::{Correction, SpeedDependentPump};
use crate::pump_file::PumpFile;

/// A plan with the pump that it was made for.
pub(crate) struct SpeedPlan {
    pub(crate) model: Pump,
    pub(crate) plan: Plan,
    /// Calibration or law that was applied; `None` of a pump as its model is.
    pub(crate) applied: Option<Applied>,
    /// Warning of a speed that the calibration or law limits.
    pub(crate) warning: Option<String>,
}

/// Pump, calibration and limits that a dose is planned with.
pub(crate) struct Planner<'a> {
    pub(crate) file: &'a PumpFile,
    /// Pump as it is without calibration.
    pub(crate) pump: &'a SpeedDependentPump,
    pub(crate) stored: Option<&'a Stored>,
    pub(crate) limits: &'a Limits,
}

impl Planner<'_> {
    /// Refuses a calibration of another pump. A zero alone suits any pump.
    fn check_stored(&self) -> Result<(), CalibrationError> {
        let is_of_pump = |stored: &&Stored| {
            stored.calibration.displacement.is_some() || stored.calibration.pulse.is_some()
        };
        match self.stored.filter(is_of_pump) {
            Some(stored) if !stored.is_of(self.pump.base()) => {
                let (then_ml, now_ml) = (stored.calibration.revolution_ml, self.pump.base().revolution_ml());
                Err(CalibrationError::OtherPump { version: stored.version, then_ml, now_ml })
            }
            _ => Ok(()),
        }
    }

    /// Plans with kappa(N), N the cruise speed, ramps included. At a rate N is the root of kappa(N) V_rot
    /// N/60 = Q. Within a time a search finds N: it plans again with the displacement at the speed found
    /// before, until both agree.
    ///
    /// # Errors
    ///
    /// [`CalibrationError::OtherPump`] if another pump was calibrated. A refusal that names the calibrated
    /// speeds if the dose cruises outside of them. The errors of [`Doser::plan`].
    pub(crate) fn plan(&self, start: Phase, request: &Request) -> Result<SpeedPlan, DoseError> {
        self.check_stored()?;
        let Some(against) = self.against() else {
            return self.at_speed(None, 0.0, start, request);
        };
        let against = &against;
        match request.cruise {
            Cruise::Speed { rad_s } => {
                let speed_rpm = rpm(rad_s);
                self.covers(against, speed_rpm, request, || format!("{speed_rpm:.4} r/min"))?;
                self.at_speed(Some(against), speed_rpm, start, request)
            }
            Cruise::Flow { ml_s } => {
                let asked = || format!("{ml_s} mL/s");
                let speed_rpm =
                    against.speed_for_flow(ml_s, reverse(request)).map_err(CalibrationError::from)?;
                let Some(speed_rpm) = speed_rpm else {
                    return Err(self.outside_flows(against, ml_s, request));
                };
                self.covers(against, speed_rpm, request, asked)?;
                self.at_speed(Some(against), speed_rpm, start, request)
            }
            Cruise::Within { time_s } => self.within(against, time_s, start, request),
            Cruise::Fastest => self.fastest(against, start, request),
        }
    }

    /// Returns the displacement against speed up to the motor's limit, or `None` of a pump as its model is.
    fn against(&self) -> Option<AgainstSpeed<'_>> {
        let displacement = self.stored.and_then(|stored| stored.calibration.displacement.as_ref());
        let against = AgainstSpeed::of(displacement, self.pump)?;
        Some(against.up_to(rpm(self.limits.motor.max_speed_rad_s)))
    }

    /// Plans with the displacement at a speed in r/min, positive.
    fn at_speed(
        &self,
        against: Option<&AgainstSpeed<'_>>,
        rpm: f64,
        start: Phase,
        request: &Request,
    ) -> Result<SpeedPlan, DoseError> {
        let applied = self.applied(against, rpm, request).map_err(CalibrationError::from)?;
        let correction = applied.as_ref().map_or(Correction::NONE, |applied| applied.correction);
        let model = correction.of(self.pump.base()).map_err(CalibrationError::from)?;
        let plan = Doser::new(&model, *self.limits)?.plan(start, request)?;
        Ok(SpeedPlan { model, plan, applied, warning: None })
    }

    /// Returns the calibration or law as applied at a speed in r/min, positive.
    fn applied(
        &self,
        against: Option<&AgainstSpeed<'_>>,
        rpm: f64,
        request: &Request,
    ) -> Result<Option<Applied>, ModelError> {
        if against.is_none() && self.stored.is_none() {
            return Ok(None);
        }
        let calibration = self.stored.map(|stored| &stored.calibration);
        let signed_rpm = signed(rpm, request);
        let displacement = match calibration {
            Some(calibration) => calibration.sureness_at(self.pump.base(), signed_rpm, self.file)?,
            None => None,
        };
        let known = self.stored.zip(displacement);
        let unweighed_speed = known.and_then(|(stored, sureness)| {
            sureness.warning(stored.version, stored.calibration.displacement.as_ref()?, rpm)
        });
        let applied = Applied {
            calibration: self.stored.map(|Stored { version, calibration }| Made {
                version: *version,
                date: calibration.date.clone(),
                fluid: calibration.fluid.clone(),
                temperature_degc: calibration.temperature_degc,
                steps_per_rev: calibration.steps_per_rev,
                head: calibration.head.clone(),
            }),
            correction: Correction {
                factor: against.map_or(Ok(1.0), |against| against.factor_at(signed_rpm))?,
                ..calibration.map_or(Correction::NONE, |calibration| calibration.shape())
            },
            basis: match displacement {
                Some(sureness) => Basis::Weighed(sureness),
                None => against.and(self.file.law_standard()).map_or(Basis::Model, Basis::Law),
            },
            zero_standard_rad: calibration.map_or(0.0, |calibration| radians(calibration.zero_standard_deg)),
            pulse: calibration.and_then(|calibration| calibration.pulse_sureness()),
            turns: calibration.map_or_else(Vec::new, |calibration| calibration.turns()),
            unweighed_speed,
        };
        Ok(Some(applied))
    }
}

/// True if a dose runs in reverse.
fn reverse(request: &Request) -> bool {
    request.volume_ml + request.carry_in_ml < 0.0
}

/// Returns a speed with the sign of a dose's direction.
fn signed(rpm: f64, request: &Request) -> f64 {
    if reverse(request) { -rpm } else { rpm }
}
