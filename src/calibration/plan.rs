//! Plans of a calibrated pump: the displacement is that at the plan's own cruise speed.

use pump_ctl::plan::{Cruise, Limits, Phase, Plan, PlanError, Request, plan};
use pump_model::Pump;
use pump_model::math::{rad_s, rpm};

use super::{Applied, CalibrationError, Displacement, Stored};
use crate::error::DoseError;
use crate::pump_file::PumpFile;

/// Model volumes of a revolution that are the same.
const SAME_PUMP: f64 = 1e-9;

/// Rounds until speed and displacement agree; three are usual. Whole steps may keep two speeds apart for ever.
const MOST_ROUNDS: u32 = 20;

/// Factors that are the same: 1e-9 of a volume is far below a step.
const SAME_FACTOR: f64 = 1e-12;

/// Part by which a speed is raised until it meets its time, and how often.
const FASTER: f64 = 1e-6;
const MOST_RAISES: u32 = 1000;

/// A plan with the pump that it was made for.
pub(crate) struct CalibratedPlan {
    pub(crate) model: Pump,
    pub(crate) plan: Plan,
    pub(crate) applied: Applied,
    pub(crate) warning: Option<String>,
}

/// What a dose is planned with.
pub(crate) struct Planner<'a> {
    pub(crate) file: &'a PumpFile,
    /// The pump as it is without calibration.
    pub(crate) base: &'a Pump,
    pub(crate) stored: &'a Stored,
    pub(crate) limits: &'a Limits,
}

impl Planner<'_> {
    /// Plans with kappa(N), N the cruise speed, ramps included. At a rate N is the root of kappa(N) V_rot N/60 = Q; within a
    /// time it is found by planning again with the displacement at the speed found before, until both agree.
    pub(crate) fn plan(&self, start: Phase, request: &Request) -> Result<CalibratedPlan, DoseError> {
        let calibration = &self.stored.calibration;
        let Some(displacement) = &calibration.displacement else {
            return self.at_speed(0.0, start, request);
        };
        let (then_ml, now_ml) = (calibration.revolution_ml, self.base.revolution_ml());
        if (then_ml - now_ml).abs() > SAME_PUMP * now_ml {
            let version = self.stored.version;
            return Err(CalibrationError::OtherPump { version, then_ml, now_ml }.into());
        }
        match request.cruise {
            Cruise::Speed { rad_s } => {
                let speed_rpm = rpm(rad_s);
                self.covers(displacement, speed_rpm, || format!("{speed_rpm:.4} r/min"))?;
                self.at_speed(speed_rpm, start, request)
            }
            Cruise::Flow { ml_s } => {
                let asked = || format!("{ml_s} mL/s");
                let speed_rpm = displacement
                    .speed_for_flow(now_ml, ml_s)
                    .ok_or_else(|| self.outside(displacement, asked()))?;
                self.covers(displacement, speed_rpm, asked)?;
                self.at_speed(speed_rpm, start, request)
            }
            Cruise::Within { time_s } => self.within(displacement, time_s, start, request),
            Cruise::Fastest => self.fastest(displacement, start, request),
        }
    }

    fn at_speed(&self, rpm: f64, start: Phase, request: &Request) -> Result<CalibratedPlan, DoseError> {
        let (applied, warning) = self.applied(rpm);
        let model = applied.correction.of(self.base).map_err(CalibrationError::from)?;
        let plan = plan(&model, start, request, self.limits)?;
        Ok(CalibratedPlan { model, plan, applied, warning })
    }

    /// The calibration at a speed, and what the user should know of that speed.
    fn applied(&self, rpm: f64) -> (Applied, Option<String>) {
        let Stored { version, calibration } = self.stored;
        let applied = calibration.at(*version, rpm, self.file);
        let known = applied.displacement.zip(calibration.displacement.as_ref());
        let warning =
            known.and_then(|(sureness, displacement)| sureness.warning(*version, displacement, rpm));
        (applied, warning)
    }

    fn within(
        &self,
        displacement: &Displacement,
        time_s: f64,
        start: Phase,
        request: &Request,
    ) -> Result<CalibratedPlan, DoseError> {
        // On the way only: what is found must lie within the speeds itself.
        let (least_rpm, most_rpm) = displacement.range_rpm();
        let inside = |rpm: f64| if displacement.is_line() { rpm.clamp(least_rpm, most_rpm) } else { rpm };
        let asked = |rpm: f64| format!("{rpm:.4} r/min, the slowest within {time_s} s,");
        let mut speed_rpm = displacement.reference_rpm;
        for _ in 0..MOST_ROUNDS {
            let planned = self.at_speed(inside(speed_rpm), start, request)?;
            speed_rpm = rpm(planned.plan.profile.cruise_rad_s());
            let (with, found) =
                (planned.applied.correction.factor, displacement.factor_at(inside(speed_rpm)));
            if (found - with).abs() <= SAME_FACTOR {
                self.covers(displacement, speed_rpm, || asked(speed_rpm))?;
                let (applied, warning) = self.applied(speed_rpm);
                return Ok(CalibratedPlan { applied, warning, ..planned });
            }
        }
        // Two numbers of steps take turns: the speed found last, raised until the dose with its own displacement is in time.
        let mut shortest_s = f64::INFINITY;
        for _ in 0..MOST_RAISES {
            self.covers(displacement, speed_rpm, || asked(speed_rpm))?;
            let request = Request { cruise: Cruise::Speed { rad_s: rad_s(speed_rpm) }, ..*request };
            let planned = self.at_speed(speed_rpm, start, &request)?;
            let takes_s = planned.plan.profile.duration_s() + planned.plan.predict(&planned.model)?.settle_s;
            if takes_s <= time_s {
                return Ok(planned);
            }
            shortest_s = shortest_s.min(takes_s);
            speed_rpm *= 1.0 + FASTER;
        }
        Err(PlanError::TimeTooShort { asked_s: time_s, fastest_s: shortest_s }.into())
    }

    /// The fastest plan within the calibrated speeds: again and again with the displacement at the speed found before.
    fn fastest(
        &self,
        displacement: &Displacement,
        start: Phase,
        request: &Request,
    ) -> Result<CalibratedPlan, DoseError> {
        let (least_rpm, most_rpm) = displacement.range_rpm();
        let mut limits = *self.limits;
        let ends_early = displacement.is_line() && rad_s(most_rpm) < limits.motor.max_speed_rad_s;
        if ends_early {
            limits.motor.max_speed_rad_s = rad_s(most_rpm);
        }
        let within = Planner { limits: &limits, ..*self };
        let mut speed_rpm = displacement.reference_rpm;
        for _ in 0..MOST_ROUNDS {
            let planned = within.at_speed(speed_rpm, start, request)?;
            let found_rpm = rpm(planned.plan.profile.cruise_rad_s());
            let (with, found) = (planned.applied.correction.factor, displacement.factor_at(found_rpm));
            // What limits the speed is found to 1e-6 of it, so the displacement is not known better.
            if (found - with).abs() <= FASTER {
                self.covers(displacement, found_rpm, || format!("{found_rpm:.4} r/min, the fastest,"))?;
                let (applied, mut warning) = self.applied(found_rpm);
                if ends_early && found_rpm > most_rpm * (1.0 - FASTER) {
                    warning = Some(format!(
                        "the motor could turn faster, but the calibration ends at {most_rpm:.2} r/min; calibrate at higher speeds"
                    ));
                }
                return Ok(CalibratedPlan { applied, warning, ..planned });
            }
            speed_rpm = if displacement.is_line() { found_rpm.clamp(least_rpm, most_rpm) } else { found_rpm };
        }
        let version = self.stored.version;
        Err(CalibrationError::NoSpeed { version, rounds: MOST_ROUNDS }.into())
    }

    /// Refuses a speed that was not calibrated. One beyond the motor is left to the plan to refuse.
    fn covers(
        &self,
        displacement: &Displacement,
        speed_rpm: f64,
        asked: impl Fn() -> String,
    ) -> Result<(), DoseError> {
        let beyond_motor = rad_s(speed_rpm) > self.limits.motor.max_speed_rad_s * (1.0 + 1e-12);
        if displacement.covers(speed_rpm) || beyond_motor {
            Ok(())
        } else {
            Err(self.outside(displacement, asked()).into())
        }
    }

    fn outside(&self, displacement: &Displacement, asked: String) -> CalibrationError {
        let (least_rpm, most_rpm) = displacement.range_rpm();
        let flow_ml_s = |rpm: f64| displacement.factor_at(rpm) * self.base.revolution_ml() * rpm / 60.0;
        CalibrationError::OutsideSpeeds {
            version: self.stored.version,
            least_rpm,
            most_rpm,
            least_ml_s: flow_ml_s(least_rpm),
            most_ml_s: flow_ml_s(most_rpm),
            asked,
        }
    }
}

#[cfg(test)]
mod tests;
