//! The slowest dose within a time, with ramps of its own.

use libm::sqrt;
use pump_model::Pump;

use super::start::Start;
use crate::plan::Plan;
use crate::plan::limits::Limits;
use crate::plan::profile::Shape;
use crate::plan::ramps::{Grid, in_time, is_no_fault, line_aware, taken_back_ml};
use crate::plan::speed::{choose, up};
use crate::plan::target::Target;
use crate::plan::words::{PlanError, Request};

/// Most cruise speeds at which a dose's own ramps are sought.
const MOST_TRIES: u32 = 24;

/// Part by which a slower cruise must miss the time.
const SLOWER: f64 = 0.99;

/// Part to which a speed is found with ramps that stay.
const NEAR: f64 = 1e-6;

/// Number of speeds at which a search tries ramps.
const SPEEDS: u32 = 16;

/// Part of the speed before. The last of the speeds is a tenth of the first.
const NEXT: f64 = 0.86;

/// Parts of the usual ramps' times that are tried from an angle that is known less well. 0 stands for the motor's
/// own ramps.
const SHORTER: [f64; 6] = [0.7, 0.5, 0.35, 0.25, 0.15, 0.0];

/// A dose that is to be done within a time.
pub(super) struct InTime<'a> {
    pub(super) start: &'a Start,
    pub(super) pump: &'a Pump,
    pub(super) target: &'a Target,
    pub(super) request: &'a Request,
    pub(super) limits: &'a Limits,
    /// Time of motion and settling, s.
    pub(super) time_s: f64,
}

/// The hurried dose that takes back least, with its back flow, mL, and the shortest time of all that were tried, s.
struct Hurried {
    best: Option<(f64, Plan)>,
    shortest_s: f64,
}

impl InTime<'_> {
    /// Plans the slowest dose in time with line-aware ramps. Where they do not meet the time, the dose has the ramps
    /// that take back least of those that do.
    #[inline(never)]
    pub(super) fn plan(&self) -> Result<Plan, PlanError> {
        let usual = self.shortened(1.0);
        let planned = if self.start.phase.is_stated() { self.stated(usual) } else { self.unstated(usual) }?;
        planned.check_ripples(self.pump)?;
        Ok(planned)
    }

    /// Plans from a stated angle, where `usual` is the dose with usual ramps.
    fn stated(&self, usual: Result<Plan, PlanError>) -> Result<Plan, PlanError> {
        // The dose's own ramps are mostly sooner than the usual ones, so that speed is in time with them.
        let of_usual = usual.as_ref().ok().map(cruise_rad_s);
        for speed_rad_s in of_usual.into_iter().chain(speeds_from(self.fastest_rad_s())) {
            if self.least_s(speed_rad_s) > self.time_s {
                break;
            }
            let own = self.own(speed_rad_s);
            if self.is_good(&own)? {
                return self.slowest(own);
            }
        }
        let mut hurried = Hurried { best: None, shortest_s: f64::INFINITY };
        if let Ok(usual) = &usual {
            self.keep_gentler(&mut hurried, usual.clone())?;
        }
        self.hurry(&mut hurried)?;
        match hurried.best {
            Some((back_ml, plan)) if is_no_fault(self.pump, &plan, back_ml) => self.slowest(plan),
            Some((_, plan)) => Ok(Plan { is_hurried: true, ..plan }),
            None => Err(self.refusal(usual.err(), hurried.shortest_s)),
        }
    }

    /// Plans from an angle that is not stated: shortens the usual ramps until they are in time, down to the motor's
    /// own.
    fn unstated(&self, usual: Result<Plan, PlanError>) -> Result<Plan, PlanError> {
        let refused = match usual {
            Err(refused @ PlanError::TimeTooShort { .. }) => refused,
            other => return other,
        };
        let mut shortest_s = f64::INFINITY;
        for part in SHORTER {
            match self.shortened(part) {
                Ok(plan) => return Ok(Plan { is_hurried: true, ..plan }),
                Err(PlanError::TimeTooShort { fastest_s, .. }) => shortest_s = shortest_s.min(fastest_s),
                Err(_) => {}
            }
        }
        Err(self.refusal(Some(refused), shortest_s))
    }

    /// Plans the slowest dose in time whose ramps take a part of the time of the usual ones. Part 0 stands for the
    /// motor's own ramps.
    fn shortened(&self, part: f64) -> Result<Plan, PlanError> {
        let Self { pump, request, limits, .. } = *self;
        choose(pump, request.cruise, limits, |speed_rad_s| {
            let usual = self.usual(speed_rad_s);
            if part >= 1.0 {
                return usual;
            }
            let profile = &usual.profile;
            let shape = profile.course.shape.filter(|_| part > 0.0);
            let shape =
                shape.map(|shape| shape.shortened(part).within(&profile.course, profile.limit_rad_s()));
            usual.with_shape(shape)
        })
    }

    /// Returns the refusal of a time that no ramps meet within the limits.
    fn refusal(&self, of_usual: Option<PlanError>, shortest_s: f64) -> PlanError {
        let too_short = |fastest_s| PlanError::TimeTooShort { asked_s: self.time_s, fastest_s };
        match of_usual {
            Some(PlanError::TimeTooShort { fastest_s, .. }) => too_short(fastest_s.min(up(shortest_s))),
            Some(refused) if shortest_s.is_infinite() => refused,
            _ => too_short(up(shortest_s)),
        }
    }

    /// Plans at a cruise speed with ramps of a shape.
    fn at(&self, speed_rad_s: f64, shape: Option<Shape>) -> Plan {
        let Self { start, pump, target, request, limits, .. } = *self;
        start.plan_at_speed(pump, target, request, &limits.motor, speed_rad_s, &|_, _| shape)
    }

    /// Plans at a cruise speed with usual ramps.
    fn usual(&self, speed_rad_s: f64) -> Plan {
        let Self { start, pump, target, request, limits, .. } = *self;
        let shape = |course: &_, speed_rad_s| Grid::new(pump.outlet(), course, speed_rad_s).usual();
        start.plan_at_speed(pump, target, request, &limits.motor, speed_rad_s, &shape)
    }

    /// Plans at a cruise speed with the ramps that are best there.
    fn own(&self, speed_rad_s: f64) -> Plan {
        let usual = self.usual(speed_rad_s);
        match line_aware(self.pump, &usual) {
            Some(shape) => usual.with_shape(Some(shape)),
            None => usual,
        }
    }

    /// Returns the shorter time of the motion at a cruise speed with usual ramps and with the motor's own, s. A rotor
    /// that is too fast at first is sooner at its end where it slows down gently.
    fn least_s(&self, speed_rad_s: f64) -> f64 {
        let usual = self.usual(speed_rad_s);
        usual.profile.duration_s().min(usual.with_shape(None).profile.duration_s())
    }

    /// Returns the fastest speed, rad/s, that the motor reaches within the turn.
    fn fastest_rad_s(&self) -> f64 {
        let limit_rad_s = self.limits.motor.max_speed_rad_s;
        self.at(limit_rad_s, None).profile.peak_rad_s().min(limit_rad_s)
    }

    /// Returns the time of motion and settling, s.
    fn total_s(&self, plan: &Plan) -> Result<f64, PlanError> {
        Ok(plan.profile.duration_s() + plan.settle_s(self.pump)?)
    }

    fn is_in_time(&self, plan: &Plan) -> Result<bool, PlanError> {
        Ok(plan.profile.duration_s() <= self.time_s && self.total_s(plan)? <= self.time_s)
    }

    fn is_good(&self, plan: &Plan) -> Result<bool, PlanError> {
        Ok(self.is_in_time(plan)? && self.limits.broken(self.pump, plan).is_none())
    }

    /// Finds the slowest cruise that is in time with its own ramps, from one that is.
    ///
    /// Ramps that stay give a time that falls evenly with the speed, but for the settling. So the search goes from a
    /// speed with its own ramps down to the slowest speed with these, and seeks the ramps anew. Where those are not in
    /// time, it halves. In the end a cruise slower by 1 % is not in time with its own ramps.
    fn slowest(&self, good: Plan) -> Result<Plan, PlanError> {
        let mut good = good;
        let mut missed_rad_s = 0.0_f64;
        for _ in 0..MOST_TRIES {
            let slower_rad_s = SLOWER * cruise_rad_s(&good);
            let is_last = slower_rad_s <= missed_rad_s;
            let like = if is_last || missed_rad_s == 0.0 {
                Some(self.slowest_like(&good, missed_rad_s)?)
            } else {
                None
            };
            let next_rad_s = match &like {
                None => sqrt(missed_rad_s * cruise_rad_s(&good)).min(slower_rad_s),
                Some(like) if is_last => SLOWER * cruise_rad_s(like),
                Some(like) => cruise_rad_s(like).min(slower_rad_s),
            };
            if let Some(next) = self.slower(&good, next_rad_s)? {
                good = next;
                missed_rad_s = if is_last { 0.0 } else { missed_rad_s };
            } else if is_last {
                // Equal ramps use the time that is left.
                let like = like.filter(|like| self.limits.broken(self.pump, like).is_none());
                return Ok(like.unwrap_or(good));
            } else {
                missed_rad_s = next_rad_s;
            }
        }
        Ok(good)
    }

    /// Plans at a slower cruise than `good` with ramps that are in time and hold the limits: its own, or those of
    /// `good` if they take back no more than they may.
    fn slower(&self, good: &Plan, speed_rad_s: f64) -> Result<Option<Plan>, PlanError> {
        let own = self.own(speed_rad_s);
        if self.is_good(&own)? {
            return Ok(Some(own));
        }
        let like = self.at(speed_rad_s, good.profile.course.shape);
        if !self.is_good(&like)? {
            return Ok(None);
        }
        let back_ml = taken_back_ml(self.pump, &like);
        let may = is_no_fault(self.pump, &like, back_ml) || back_ml <= taken_back_ml(self.pump, good);
        Ok(may.then_some(like))
    }

    /// Finds the slowest cruise above `missed_rad_s` that is in time with the ramps of `good`, which is in time.
    fn slowest_like(&self, good: &Plan, missed_rad_s: f64) -> Result<Plan, PlanError> {
        let (mut slow, mut fast) = (missed_rad_s, cruise_rad_s(good));
        let mut found = good.clone();
        while fast - slow > NEAR * fast {
            let middle = 0.5 * (slow + fast);
            let plan = self.at(middle, good.profile.course.shape);
            if self.is_in_time(&plan)? {
                (fast, found) = (middle, plan);
            } else {
                slow = middle;
            }
        }
        Ok(found)
    }

    /// Keeps a plan if it is in time, holds the limits and takes back less than the one before.
    fn keep_gentler(&self, hurried: &mut Hurried, plan: Plan) -> Result<(), PlanError> {
        if self.limits.broken(self.pump, &plan).is_some() {
            return Ok(());
        }
        let total_s = self.total_s(&plan)?;
        hurried.shortest_s = hurried.shortest_s.min(total_s);
        if total_s <= self.time_s {
            let back_ml = taken_back_ml(self.pump, &plan);
            if hurried.best.as_ref().is_none_or(|(least_ml, _)| back_ml < *least_ml) {
                hurried.best = Some((back_ml, plan));
            }
        }
        Ok(())
    }

    /// Seeks ramps at speeds from the fastest down, until the motion alone is too long. The ramps that end soonest and
    /// the motor's own count too.
    fn hurry(&self, hurried: &mut Hurried) -> Result<(), PlanError> {
        for speed_rad_s in speeds_from(self.fastest_rad_s()) {
            let least_s = self.least_s(speed_rad_s);
            if least_s > self.time_s && least_s >= hurried.shortest_s {
                break;
            }
            let usual = self.usual(speed_rad_s);
            self.keep_gentler(hurried, usual.with_shape(None))?;
            for most_s in [self.time_s, 0.0] {
                if let Some(shape) = in_time(self.pump, &usual, most_s) {
                    self.keep_gentler(hurried, usual.with_shape(Some(shape)))?;
                }
            }
        }
        if hurried.best.is_none() {
            match self.shortened(0.0) {
                Ok(plain) => self.keep_gentler(hurried, plain)?,
                Err(PlanError::TimeTooShort { fastest_s, .. }) => {
                    hurried.shortest_s = hurried.shortest_s.min(fastest_s);
                }
                Err(_) => {}
            }
        }
        Ok(())
    }
}

impl PlanError {
    /// Returns the refusal of a dose within `asked_s`, s, where the shortest time found is `shortest_s`, s. It is
    /// rounded up, so that the time that the message names is accepted.
    pub fn too_short(asked_s: f64, shortest_s: f64) -> Self {
        Self::TimeTooShort { asked_s, fastest_s: up(shortest_s) }
    }
}

/// Returns the cruise speed of a plan, rad/s, or the fastest speed of one too short to reach it. A rotor that turns
/// already may be faster.
fn cruise_rad_s(plan: &Plan) -> f64 {
    let profile = &plan.profile;
    if profile.reaches_limit() { profile.limit_rad_s() } else { profile.peak_rad_s() }
}

/// Returns the speeds at which a search tries ramps, from the fastest down.
fn speeds_from(fastest_rad_s: f64) -> impl Iterator<Item = f64> {
    let mut speed_rad_s = fastest_rad_s;
    (0..SPEEDS).map(move |_| {
        let this_rad_s = speed_rad_s;
        speed_rad_s *= NEXT;
        this_rad_s
    })
}

impl Plan {
    /// Returns this plan with ramps of another shape.
    fn with_shape(&self, shape: Option<Shape>) -> Self {
        Self { profile: self.profile.with_shape(shape), ..self.clone() }
    }
}
