//! Searches for the cruise speed of a dose within a time, and of the fastest dose.

use pump_ctl::plan::{Cruise, LimitedBy, Phase, PlanError, Request};
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

/// Number of times that a speed is raised at most. Each raise is twice the one before, up to [`MOST_RAISED`].
const MOST_RAISES: u32 = 100;

/// Largest part by which a speed is raised at once.
const MOST_RAISED: f64 = 1e-3;

/// Part by which a speed is lowered where it breaks a limit by its own displacement.
const LOWER: f64 = 1e-3;

/// Part of a motor step's volume to which a dose's volume must be that of its own speed, where the speed found
/// jumps with the displacement. The step itself is known no better than by half of it.
const PART_OF_STEP: f64 = 0.01;

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
        for round in 1..=MOST_ROUNDS {
            let planned = self.at_speed(Some(against), inside(speed_rpm), start, request)?;
            speed_rpm = rpm(planned.plan.profile().cruise_rad_s());
            let (with, found) = Self::factors(against, &planned, inside(speed_rpm), request)?;
            let same = if round < MOST_ROUNDS { SAME_FACTOR } else { same_volume(&planned) };
            if (found - with).abs() <= same {
                self.covers(against, speed_rpm, request, || slowest(speed_rpm, time_s))?;
                let applied =
                    self.applied(Some(against), speed_rpm, request).map_err(CalibrationError::from)?;
                return Ok(SpeedPlan { applied, ..planned });
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
        let mut faster = FASTER;
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
            speed_rpm *= 1.0 + faster;
            faster = (2.0 * faster).min(MOST_RAISED);
        }
        Err(PlanError::too_short(time_s, shortest_s).into())
    }

    /// Plans the fastest dose within the speeds: plans again with the displacement at the speed found before,
    /// until both agree. A dose too short to reach the slowest speed has the displacement of that speed.
    ///
    /// # Errors
    ///
    /// [`CalibrationError::NoSpeed`] if no speed has a displacement that agrees with it.
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
        let inside = |rpm: f64| range_rpm.map_or(rpm, |(least, most)| rpm.clamp(least, most));
        let mut speed_rpm = against.typical_rpm();
        let mut slowest_rpm = f64::INFINITY;
        let mut is_short = false;
        for round in 1..=MOST_ROUNDS {
            let planned = within.at_speed(Some(against), inside(speed_rpm), start, request)?;
            speed_rpm = rpm(planned.plan.profile().cruise_rad_s());
            let (with, found) = Self::factors(against, &planned, inside(speed_rpm), request)?;
            // A search finds the limiting speed to 1e-6 of it, so the displacement is not known better.
            is_short = planned.plan.limited_by() == LimitedBy::Acceleration;
            if (found - with).abs() <= FASTER.max(same_volume(&planned)) {
                return self.as_fastest(against, planned, is_short, end_rpm, request);
            }
            // The first rounds start far from the speed.
            if round > MOST_ROUNDS / 2 {
                slowest_rpm = slowest_rpm.min(speed_rpm);
            }
        }
        let lowered = within.lowered(against, slowest_rpm, start, request)?;
        self.as_fastest(against, lowered, is_short, end_rpm, request)
    }

    /// Plans the fastest dose where the speed found jumps with the displacement, as ramps of another shape are
    /// chosen: lowers the slowest of the speeds found until the dose reaches it with its own displacement.
    fn lowered(
        &self,
        against: &AgainstSpeed<'_>,
        mut speed_rpm: f64,
        start: Phase,
        request: &Request,
    ) -> Result<SpeedPlan, DoseError> {
        let range_rpm = against.range_rpm();
        let inside = |rpm: f64| range_rpm.map_or(rpm, |(least, most)| rpm.clamp(least, most));
        for _ in 0..MOST_RAISES {
            let request = request.with_cruise(Cruise::Speed { rad_s: rad_s(speed_rpm) });
            // A limit that holds with the displacement of another speed may be broken by a hair with this one.
            let Ok(planned) = self.at_speed(Some(against), inside(speed_rpm), start, &request) else {
                speed_rpm *= 1.0 - LOWER;
                continue;
            };
            let reached_rpm = rpm(planned.plan.profile().cruise_rad_s());
            let (with, found) = Self::factors(against, &planned, inside(reached_rpm), &request)?;
            if (found - with).abs() <= FASTER.max(same_volume(&planned)) {
                return Ok(planned);
            }
            speed_rpm = reached_rpm.min(speed_rpm * (1.0 - FASTER));
        }
        Err(CalibrationError::NoSpeed { rounds: MOST_RAISES }.into())
    }

    /// Returns a plan as that of the fastest dose, with the sureness and the warnings of its speed. `is_short` is
    /// true for a dose too short to reach its cruise speed.
    fn as_fastest(
        &self,
        against: &AgainstSpeed<'_>,
        planned: SpeedPlan,
        is_short: bool,
        end_rpm: Option<f64>,
        request: &Request,
    ) -> Result<SpeedPlan, DoseError> {
        let found_rpm = rpm(planned.plan.profile().cruise_rad_s());
        let least_rpm = against.range_rpm().map(|(least, _)| least).filter(|least| found_rpm < *least);
        if let Some(least_rpm) = least_rpm.filter(|_| is_short) {
            let applied = self.applied(Some(against), least_rpm, request).map_err(CalibrationError::from)?;
            let warning = Some(too_short(against, found_rpm, least_rpm));
            return Ok(SpeedPlan { applied, warning, ..planned });
        }
        self.covers(against, found_rpm, request, || format!("{found_rpm:.4} r/min, the fastest,"))?;
        let applied = self.applied(Some(against), found_rpm, request).map_err(CalibrationError::from)?;
        let is_at_end = |end: &f64| found_rpm > end * (1.0 - FASTER);
        let warning = end_rpm.filter(is_at_end).map(|end_rpm| slower_than_motor(against, end_rpm));
        Ok(SpeedPlan { applied, warning, ..planned })
    }
}

/// Returns the difference of two factors that changes a plan's volume by a hundredth of a motor step's mean.
fn same_volume(planned: &SpeedPlan) -> f64 {
    PART_OF_STEP / planned.plan.steps().unsigned_abs() as f64
}

/// Returns the warning of a dose too short to reach the speeds of the calibration or law.
fn too_short(against: &AgainstSpeed<'_>, found_rpm: f64, least_rpm: f64) -> String {
    let source = if against.displacement().is_some() { "calibration" } else { "pump file's speed law" };
    format!(
        "the dose is too short to turn faster than {found_rpm:.4} r/min, and the {source} begins at \
         {least_rpm:.2} r/min; its displacement there is taken"
    )
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
