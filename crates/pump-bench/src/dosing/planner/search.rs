//! Searches for the cruise speed of a dose within a time, and of the fastest dose.

use pump_ctl::plan::{Cruise, Phase, PlanError, Request};
use pump_model::units::{rad_s, rpm};

use super::{Planner, SpeedPlan, signed};
use crate::calibration::{AgainstSpeed, CalibrationError};
use crate::dosing::DoseError;

/// Rounds until speed and displacement agree; three are usual. Whole steps may keep two speeds apart for
/// ever.
const MOST_ROUNDS: u32 = 20;

/// Factors that differ by less than this are the same: 1e-9 of a volume is far below a step.
const SAME_FACTOR: f64 = 1e-12;

/// Part by which a speed is raised until it meets its time.
const FASTER: f64 = 1e-6;

/// Number of times that a speed is raised at most.
const MOST_RAISES: u32 = 1000;

impl Planner<'_> {
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

    /// Plans the slowest dose within a time.
    ///
    /// # Errors
    ///
    /// [`PlanError::TimeTooShort`] if no speed meets the time, and a refusal that names the speeds if the
    /// dose cruises outside of them.
    pub(super) fn within(
        &self,
        against: &AgainstSpeed<'_>,
        time_s: f64,
        start: Phase,
        request: &Request,
    ) -> Result<SpeedPlan, DoseError> {
        // On the way only: what is found must lie within the speeds itself.
        let range_rpm = against.range_rpm();
        let inside = |rpm: f64| range_rpm.map_or(rpm, |(least, most)| rpm.clamp(least, most));
        let mut speed_rpm = against.typical_rpm();
        for _ in 0..MOST_ROUNDS {
            let planned = self.at_speed(Some(against), inside(speed_rpm), start, request)?;
            speed_rpm = rpm(planned.plan.profile().cruise_rad_s());
            let (with, found) = Self::factors(against, &planned, inside(speed_rpm), request)?;
            if (found - with).abs() <= SAME_FACTOR {
                self.covers(against, speed_rpm, request, || slowest(speed_rpm, time_s))?;
                let (applied, warning) =
                    self.applied(Some(against), speed_rpm, request).map_err(CalibrationError::from)?;
                return Ok(SpeedPlan { applied, warning, ..planned });
            }
        }
        self.raised(against, speed_rpm, time_s, start, request)
    }

    /// Plans within a time where two numbers of steps take turns: raises the speed found last until the dose
    /// with its own displacement is in time.
    fn raised(
        &self,
        against: &AgainstSpeed<'_>,
        mut speed_rpm: f64,
        time_s: f64,
        start: Phase,
        request: &Request,
    ) -> Result<SpeedPlan, DoseError> {
        let mut shortest_s = f64::INFINITY;
        for _ in 0..MOST_RAISES {
            self.covers(against, speed_rpm, request, || slowest(speed_rpm, time_s))?;
            let request = request.with_cruise(Cruise::Speed { rad_s: rad_s(speed_rpm) });
            let planned = self.at_speed(Some(against), speed_rpm, start, &request)?;
            let takes_s =
                planned.plan.profile().duration_s() + planned.plan.predict(&planned.model)?.settle_s;
            if takes_s <= time_s {
                return Ok(planned);
            }
            shortest_s = shortest_s.min(takes_s);
            speed_rpm *= 1.0 + FASTER;
        }
        Err(PlanError::TimeTooShort { asked_s: time_s, fastest_s: shortest_s }.into())
    }

    /// Plans the fastest dose within the speeds: plans again with the displacement at the speed found before,
    /// until both agree.
    ///
    /// # Errors
    ///
    /// [`CalibrationError::NoSpeed`] if they do not agree in 20 rounds.
    pub(super) fn fastest(
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
            let found_rpm = rpm(planned.plan.profile().cruise_rad_s());
            let (with, found) = Self::factors(against, &planned, found_rpm, request)?;
            // A search finds the limiting speed to 1e-6 of it, so the displacement is not known better.
            if (found - with).abs() <= FASTER {
                let asked = || format!("{found_rpm:.4} r/min, the fastest,");
                self.covers(against, found_rpm, request, asked)?;
                let (applied, mut warning) =
                    self.applied(Some(against), found_rpm, request).map_err(CalibrationError::from)?;
                if let Some(end_rpm) = end_rpm.filter(|end| found_rpm > end * (1.0 - FASTER)) {
                    warning = Some(slower_than_motor(against, end_rpm));
                }
                return Ok(SpeedPlan { applied, warning, ..planned });
            }
            speed_rpm = range_rpm.map_or(found_rpm, |(least, most)| found_rpm.clamp(least, most));
        }
        Err(CalibrationError::NoSpeed { rounds: MOST_ROUNDS }.into())
    }
}

/// Returns the words for a speed in r/min that is the slowest within a time.
fn slowest(speed_rpm: f64, time_s: f64) -> String {
    format!("{speed_rpm:.4} r/min, the slowest within {time_s} s,")
}

/// Returns the warning of a dose whose speed is limited by the calibration or law, and not by the motor.
fn slower_than_motor(against: &AgainstSpeed<'_>, end_rpm: f64) -> String {
    let (what, then) = match against.displacement() {
        Some(_) => ("calibration", "calibrate at higher speeds"),
        None => ("pump file's speed law", "raise its most_rpm if it holds there"),
    };
    format!("the motor could turn faster, but the {what} ends at {end_rpm:.2} r/min; {then}")
}
