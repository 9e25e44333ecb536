//! Plans of a pump whose displacement depends on the speed. A plan uses the displacement at its own cruise
//! speed.

use pump_ctl::plan::{Cruise, Limits, Phase, Plan, PlanError, Request, plan};
use pump_model::math::{rad_s, radians, rpm};
use pump_model::{ModelError, Pump};

use super::error::DoseError;
use crate::calibration::{AgainstSpeed, Applied, CalibrationError, Made, Stored};
use crate::displacement::{Correction, RangedLaw, SpeedLawError};
use crate::pump_file::PumpFile;

/// Relative difference up to which two model volumes of a revolution are equal.
const SAME_PUMP: f64 = 1e-9;

/// Most rounds until speed and displacement agree. Three are usual. Two speeds may alternate forever, because
/// steps are whole.
const MOST_ROUNDS: u32 = 20;

/// Difference up to which two factors are equal: 1e-9 of a volume is far below a step.
const SAME_FACTOR: f64 = 1e-12;

/// Part by which a speed is raised until the dose meets its time.
const FASTER: f64 = 1e-6;
/// Most raises of a speed until the dose meets its time.
const MOST_RAISES: u32 = 1000;

/// Plan with the pump that it was made for.
pub(crate) struct SpeedPlan {
    pub(crate) model: Pump,
    pub(crate) plan: Plan,
    /// Calibration and speed law that corrected the pump. `None` for a pump as its model is.
    pub(crate) applied: Option<Applied>,
    pub(crate) warning: Option<String>,
}

/// Planner of doses: the pump, its calibration or speed law, and the limits.
pub(crate) struct Planner<'a> {
    pub(crate) file: &'a PumpFile,
    /// Pump without calibration and speed law.
    pub(crate) base: &'a Pump,
    pub(crate) stored: Option<&'a Stored>,
    /// Speed law of the pump file, if the plan is to use it.
    pub(crate) law: Option<RangedLaw>,
    pub(crate) limits: &'a Limits,
}

impl Planner<'_> {
    /// Plans with kappa(N), the displacement at the cruise speed N, ramps included.
    ///
    /// At a rate Q, N is the root of kappa(N) V_rot N/60 = Q. Within a time, N is found by planning again
    /// with the displacement at the speed found before, until both agree.
    pub(crate) fn plan(&self, start: Phase, request: &Request) -> Result<SpeedPlan, DoseError> {
        let Some(against) = self.against() else {
            return self.at_speed(None, 0.0, start, request);
        };
        let against = &against;
        if let Some(stored) = self.stored.filter(|_| against.displacement().is_some()) {
            let (then_ml, now_ml) = (stored.calibration.revolution_ml, self.base.revolution_ml());
            if (then_ml - now_ml).abs() > SAME_PUMP * now_ml {
                let version = stored.version;
                return Err(CalibrationError::OtherPump { version, then_ml, now_ml }.into());
            }
        }
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

    /// Returns the displacement against speed, up to the motor's limit. `None` for a pump as its model is.
    fn against(&self) -> Option<AgainstSpeed<'_>> {
        let displacement = self.stored.and_then(|stored| stored.calibration.displacement.as_ref());
        let against = AgainstSpeed::of(displacement, self.law, self.base)?;
        Some(against.up_to(rpm(self.limits.motor.max_speed_rad_s)))
    }

    fn at_speed(
        &self,
        against: Option<&AgainstSpeed<'_>>,
        rpm: f64,
        start: Phase,
        request: &Request,
    ) -> Result<SpeedPlan, DoseError> {
        let (applied, warning) = self.applied(against, rpm, request).map_err(CalibrationError::from)?;
        let correction = applied.as_ref().map_or(Correction::NONE, |applied| applied.correction);
        let model = correction.of(self.base).map_err(CalibrationError::from)?;
        let plan = plan(&model, start, request, self.limits)?;
        Ok(SpeedPlan { model, plan, applied, warning })
    }

    /// Returns the correction of the pump at a speed in r/min, positive, and a warning of that speed.
    fn applied(
        &self,
        against: Option<&AgainstSpeed<'_>>,
        rpm: f64,
        request: &Request,
    ) -> Result<(Option<Applied>, Option<String>), ModelError> {
        if against.is_none() && self.stored.is_none() {
            return Ok((None, None));
        }
        let calibration = self.stored.map(|stored| &stored.calibration);
        let signed_rpm = signed(rpm, request);
        let displacement = match calibration {
            Some(calibration) => calibration.sureness_at(self.base, signed_rpm, self.file)?,
            None => None,
        };
        let known = self.stored.zip(displacement);
        let warning = known.and_then(|(stored, sureness)| {
            sureness.warning(stored.version, stored.calibration.displacement.as_ref()?, rpm)
        });
        let applied = Applied {
            calibration: self.stored.map(|Stored { version, calibration }| Made {
                version: *version,
                date: calibration.date.clone(),
            }),
            correction: Correction {
                factor: against.map_or(Ok(1.0), |against| against.factor_at(signed_rpm))?,
                zero_rad: calibration.map_or(0.0, |calibration| calibration.zero_rad()),
            },
            displacement,
            speed_law: if displacement.is_none() && against.is_some() {
                self.file.speed_law.standard()
            } else {
                None
            },
            zero_standard_rad: calibration.map_or(0.0, |calibration| radians(calibration.zero_standard_deg)),
        };
        Ok((Some(applied), warning))
    }

    /// Returns the displacement that a plan was made with, and the displacement at the speed that was found.
    fn factors(
        against: &AgainstSpeed<'_>,
        planned: &SpeedPlan,
        found_rpm: f64,
        request: &Request,
    ) -> Result<(f64, f64), DoseError> {
        let with = planned.applied.as_ref().map_or(1.0, |applied| applied.correction.factor);
        let found = against.factor_at(signed(found_rpm, request)).map_err(CalibrationError::from)?;
        Ok((with, found))
    }

    fn within(
        &self,
        against: &AgainstSpeed<'_>,
        time_s: f64,
        start: Phase,
        request: &Request,
    ) -> Result<SpeedPlan, DoseError> {
        // Only the search is clamped: the speed that is found must lie within the range itself.
        let range_rpm = against.range_rpm();
        let inside = |rpm: f64| range_rpm.map_or(rpm, |(least, most)| rpm.clamp(least, most));
        let asked = |rpm: f64| format!("{rpm:.4} r/min, the slowest within {time_s} s,");
        let mut speed_rpm = against.typical_rpm();
        for _ in 0..MOST_ROUNDS {
            let planned = self.at_speed(Some(against), inside(speed_rpm), start, request)?;
            speed_rpm = rpm(planned.plan.profile.cruise_rad_s());
            let (with, found) = Self::factors(against, &planned, inside(speed_rpm), request)?;
            if (found - with).abs() <= SAME_FACTOR {
                self.covers(against, speed_rpm, request, || asked(speed_rpm))?;
                let (applied, warning) =
                    self.applied(Some(against), speed_rpm, request).map_err(CalibrationError::from)?;
                return Ok(SpeedPlan { applied, warning, ..planned });
            }
        }
        // Two numbers of steps take turns. The speed found last is raised until the dose with its own
        // displacement is in time.
        let mut shortest_s = f64::INFINITY;
        for _ in 0..MOST_RAISES {
            self.covers(against, speed_rpm, request, || asked(speed_rpm))?;
            let request = Request { cruise: Cruise::Speed { rad_s: rad_s(speed_rpm) }, ..*request };
            let planned = self.at_speed(Some(against), speed_rpm, start, &request)?;
            let takes_s = planned.plan.profile.duration_s() + planned.plan.predict(&planned.model)?.settle_s;
            if takes_s <= time_s {
                return Ok(planned);
            }
            shortest_s = shortest_s.min(takes_s);
            speed_rpm *= 1.0 + FASTER;
        }
        Err(PlanError::TimeTooShort { asked_s: time_s, fastest_s: shortest_s }.into())
    }

    /// Finds the fastest plan within the speeds. Each round uses the displacement at the speed found before.
    fn fastest(
        &self,
        against: &AgainstSpeed<'_>,
        start: Phase,
        request: &Request,
    ) -> Result<SpeedPlan, DoseError> {
        let range_rpm = against.range_rpm();
        let mut limits = *self.limits;
        let end_rpm =
            range_rpm.map(|(_, most)| most).filter(|most| rad_s(*most) < limits.motor.max_speed_rad_s);
        if let Some(end_rpm) = end_rpm {
            limits.motor.max_speed_rad_s = rad_s(end_rpm);
        }
        let within = Planner { limits: &limits, ..*self };
        let mut speed_rpm = against.typical_rpm();
        for _ in 0..MOST_ROUNDS {
            let planned = within.at_speed(Some(against), speed_rpm, start, request)?;
            let found_rpm = rpm(planned.plan.profile.cruise_rad_s());
            let (with, found) = Self::factors(against, &planned, found_rpm, request)?;
            // The limit is found to 1e-6 of the speed, so the displacement is known no better.
            if (found - with).abs() <= FASTER {
                let asked = || format!("{found_rpm:.4} r/min, the fastest,");
                self.covers(against, found_rpm, request, asked)?;
                let (applied, mut warning) =
                    self.applied(Some(against), found_rpm, request).map_err(CalibrationError::from)?;
                if let Some(end_rpm) = end_rpm.filter(|end| found_rpm > end * (1.0 - FASTER)) {
                    let (what, then) = match against.displacement() {
                        Some(_) => ("calibration", "calibrate at higher speeds"),
                        None => ("pump file's speed law", "raise its most_rpm if it holds there"),
                    };
                    warning = Some(format!(
                        "the motor could turn faster, but the {what} ends at {end_rpm:.2} r/min; {then}"
                    ));
                }
                return Ok(SpeedPlan { applied, warning, ..planned });
            }
            speed_rpm = range_rpm.map_or(found_rpm, |(least, most)| found_rpm.clamp(least, most));
        }
        Err(CalibrationError::NoSpeed { rounds: MOST_ROUNDS }.into())
    }

    /// Refuses a speed outside the known range. A speed beyond the motor is left to the plan to refuse.
    fn covers(
        &self,
        against: &AgainstSpeed<'_>,
        speed_rpm: f64,
        request: &Request,
        asked: impl Fn() -> String,
    ) -> Result<(), DoseError> {
        let beyond_motor = rad_s(speed_rpm) > self.limits.motor.max_speed_rad_s * (1.0 + 1e-12);
        if against.covers(speed_rpm) || beyond_motor {
            return Ok(());
        }
        Err(self
            .outside(against, asked(), request)
            .unwrap_or_else(|error| CalibrationError::from(error).into()))
    }

    /// Returns the refusal of a flow that no speed gives.
    fn outside_flows(&self, against: &AgainstSpeed<'_>, ml_s: f64, request: &Request) -> DoseError {
        let found = match (against.displacement(), against.law()) {
            (None, Some(law)) => law.outside_flows(self.base, ml_s, reverse(request)).map(DoseError::from),
            _ => self.outside(against, format!("{ml_s} mL/s"), request),
        };
        found.unwrap_or_else(|error| CalibrationError::from(error).into())
    }

    fn outside(
        &self,
        against: &AgainstSpeed<'_>,
        asked: String,
        request: &Request,
    ) -> Result<DoseError, ModelError> {
        let (least_rpm, most_rpm) = against.range_rpm().unwrap_or((0.0, f64::INFINITY));
        let Some(stored) = self.stored.filter(|_| against.displacement().is_some()) else {
            return Ok(SpeedLawError::OutsideSpeeds { asked, least_rpm, most_rpm }.into());
        };
        let (least_ml_s, most_ml_s) = against.flows_ml_s(reverse(request))?.unwrap_or((0.0, f64::INFINITY));
        let version = stored.version;
        let outside =
            CalibrationError::OutsideSpeeds { version, least_rpm, most_rpm, least_ml_s, most_ml_s, asked };
        Ok(outside.into())
    }
}

/// Returns true if a dose runs in reverse.
fn reverse(request: &Request) -> bool {
    request.volume_ml + request.carry_in_ml < 0.0
}

/// Returns a speed with the sign of the dose's direction.
fn signed(rpm: f64, request: &Request) -> f64 {
    if reverse(request) { -rpm } else { rpm }
}

#[cfg(test)]
mod by_law;
#[cfg(test)]
mod tests;
