//! The plan: a dose, ready to run.

use pump_model::Leg;

use super::line_states::LineStates;
use super::profile::{Legs, Profile};
use super::words::{Finish, LimitedBy, Phase, Ramps, Turned};
use crate::step::Direction;

/// A dose, ready to run. [`crate::plan::Doser`] makes it.
///
/// A plan has no form of its own for a wire or a file. It depends on its request, its limits and the pump alone,
/// to the last bit. So send those and plan again, or send its [`Self::segments`] and the motor's brake.
///
/// ```
/// use pump_ctl::plan::{Cruise, Doser, Limits, Motor, Phase, Request};
/// use pump_ctl::step::Direction;
///
/// let pump = pump_model::Pump::three_roller();
/// let motor = Motor::new(12_800.0, 17.8, 500.0);
/// let request = Request::new(25.0, Cruise::Flow { ml_s: 5.0 });
/// let plan = Doser::new(&pump, Limits::new(motor))?.plan(Phase::known(0.0), &request)?;
/// assert_eq!((plan.steps(), plan.direction()), (15_480, Direction::Forward));
/// assert!((plan.profile().duration_s() - 5.22).abs() < 0.01);
/// assert!(plan.predict(&pump)?.outlet.max_kpa > pump.outlet().reservoir_kpa);
/// # Ok::<(), pump_ctl::plan::PlanError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Plan {
    pub(super) requested_ml: f64,
    pub(super) carry_in_ml: f64,
    pub(super) planned_ml: f64,
    pub(super) least_ml: f64,
    pub(super) most_ml: f64,
    pub(super) carry_ml: f64,
    pub(super) finish: Finish,
    pub(super) start: Phase,
    pub(super) turned: Turned,
    pub(super) steps: i64,
    pub(super) steps_per_rev: f64,
    pub(super) step_rad: f64,
    pub(super) profile: Profile,
    pub(super) ramps: Ramps,
    pub(super) is_hurried: bool,
    pub(super) limited_by: LimitedBy,
    pub(super) before_ml: f64,
    /// States of inlet and outlet line at the start.
    pub(super) lines: LineStates,
}

impl Plan {
    /// Returns the volume asked for, mL, negative in reverse.
    pub fn requested_ml(&self) -> f64 {
        self.requested_ml
    }

    /// Returns the carry of earlier doses, mL.
    pub fn carry_in_ml(&self) -> f64 {
        self.carry_in_ml
    }

    /// Returns the volume of the planned steps once the line has settled, mL.
    ///
    /// It is the volume from a stated start angle ([`Phase::is_stated`]). From an angle that is known less well it
    /// is the growth of the middle of [`Self::turned`]: for a dose alone, the middle of the range.
    pub fn planned_ml(&self) -> f64 {
        self.planned_ml
    }

    /// Returns the smallest volume that the planned steps deliver from an angle at which the rollers may stand,
    /// mL.
    ///
    /// It equals the planned volume if the angle is known exactly. In reverse it is farther from zero than
    /// [`Self::most_ml`].
    pub fn least_ml(&self) -> f64 {
        self.least_ml
    }

    /// Returns the largest volume that the planned steps deliver from an angle at which the rollers may stand,
    /// mL.
    pub fn most_ml(&self) -> f64 {
        self.most_ml
    }

    /// Returns the carry to the next dose, mL: requested + carry of earlier doses - planned.
    pub fn carry_ml(&self) -> f64 {
        self.carry_ml
    }

    /// Returns the place in a pitch at which the dose may end.
    pub fn finish(&self) -> Finish {
        self.finish
    }

    /// Returns the angle of the rollers at the start.
    pub fn start(&self) -> Phase {
        self.start
    }

    /// Returns the turn of the earlier doses, before this plan.
    pub fn turned(&self) -> Turned {
        self.turned
    }

    /// Returns the number of motor steps, negative in reverse.
    pub fn steps(&self) -> i64 {
        self.steps
    }

    /// Returns the steps per revolution of the pump head.
    pub fn steps_per_rev(&self) -> f64 {
        self.steps_per_rev
    }

    /// Returns the angle of a step, rad.
    pub fn step_rad(&self) -> f64 {
        self.step_rad
    }

    /// Returns the steps that are made along the speed limit, between the two ramps. They are counted from the start.
    /// The range is empty if the motion does not reach the limit.
    pub fn cruise_steps(&self) -> core::ops::Range<u64> {
        let [reached, left] = self.profile.corners_rad.map(|angle_rad| (angle_rad / self.step_rad) as u64);
        if self.profile.reaches_limit() { reached..left } else { 0..0 }
    }

    /// Returns the speed of the pump head over time.
    pub fn profile(&self) -> &Profile {
        &self.profile
    }

    /// Returns the choice of the ramps in which the dose starts and stops.
    pub fn ramps(&self) -> Ramps {
        self.ramps
    }

    /// Returns true if the time asked for leaves no room for ramps that leave the line nearly at rest.
    ///
    /// The ramps then are those that take back least within the time. [`Self::back_flow`] says how much.
    pub fn is_hurried(&self) -> bool {
        self.is_hurried
    }

    /// Returns the limit that keeps the cruise speed down.
    pub fn limited_by(&self) -> LimitedBy {
        self.limited_by
    }

    /// Returns the volume that the dose had delivered when this plan took over, mL.
    ///
    /// It is 0 unless [`crate::plan::Doser::retarget`] or [`Self::stop`] made the plan.
    pub fn before_ml(&self) -> f64 {
        self.before_ml
    }

    /// Returns the plan with the volume and the carry of earlier doses that it is booked with. Its motion stays,
    /// and its carry is the new requested + carry of earlier doses - planned.
    ///
    /// Use it where the target of the motion was found in another way than from the volume asked for.
    #[must_use]
    pub fn booked_as(self, requested_ml: f64, carry_in_ml: f64) -> Self {
        Self { requested_ml, carry_in_ml, carry_ml: requested_ml + carry_in_ml - self.planned_ml, ..self }
    }

    /// Returns the direction in which the rotor turns.
    pub fn direction(&self) -> Direction {
        Direction::of(self.steps)
    }

    /// Returns the angle at the end, rad, counted on from the start angle.
    pub fn end_angle_rad(&self) -> f64 {
        self.angle_after(self.steps.unsigned_abs())
    }

    /// Returns the angle after `count` steps, rad, counted on from the start angle.
    pub fn angle_after(&self, count: u64) -> f64 {
        self.start.angle_rad + f64::from(self.direction().sign()) * (count as f64 * self.step_rad)
    }

    /// Returns the turn of the earlier doses and of the first `count` steps.
    pub fn turned_after(&self, count: u64) -> Turned {
        let turn_rad = f64::from(self.direction().sign()) * (count as f64 * self.step_rad);
        self.turned.by(turn_rad, turn_rad)
    }

    /// Returns the speed of the pump head when `count` steps are made, rad/s, not negative.
    pub fn speed_after(&self, count: u64) -> f64 {
        self.profile.speed_at(count as f64 * self.step_rad)
    }

    /// Returns the motion as legs: ramp, cruise, ramp. After them the motor holds.
    pub fn legs(&self) -> Legs<'_> {
        self.profile.legs()
    }

    /// Returns the angle `t_s` after the start of motion, rad, of the smooth motion through the steps.
    ///
    /// Before the motion the angle is that of the start, after it that of the end. Use it for drives that
    /// take set-points instead of steps.
    ///
    /// ```
    /// use pump_ctl::plan::{Cruise, Doser, Limits, Motor, Phase, Request};
    ///
    /// let pump = pump_model::Pump::three_roller();
    /// let motor = Motor::new(12_800.0, 17.8, 500.0);
    /// let request = Request::new(25.0, Cruise::Flow { ml_s: 5.0 });
    /// let plan = Doser::new(&pump, Limits::new(motor))?.plan(Phase::known(0.3), &request)?;
    /// assert_eq!(plan.angle_at(-1.0), 0.3);
    /// let step = plan.each_step().nth(5000).unwrap();
    /// assert!((plan.angle_at(step.time_s) - step.angle_rad).abs() < 1e-9);
    /// assert!((plan.angle_at(60.0) - plan.end_angle_rad()).abs() < 1e-9);
    /// # Ok::<(), pump_ctl::plan::PlanError>(())
    /// ```
    pub fn angle_at(&self, t_s: f64) -> f64 {
        let t_s = t_s.max(0.0).min(self.profile.duration_s());
        self.profile.leg_at(t_s).angle_at(t_s)
    }

    /// Returns the fastest way to rest from `t_s` after the start of motion on, at the motor's largest
    /// acceleration. It never leads beyond the plan's end.
    ///
    /// A stop that somebody asks for is a matter of safety, so it takes no regard of the line's back flow.
    ///
    /// Use it for drives that take set-points. [`Self::stop`] plans a stop in steps.
    ///
    /// ```
    /// use pump_ctl::plan::{Cruise, Doser, Limits, Motor, Phase, Request};
    ///
    /// let pump = pump_model::Pump::three_roller();
    /// let motor = Motor::new(12_800.0, 17.8, 500.0);
    /// let request = Request::new(25.0, Cruise::Flow { ml_s: 5.0 });
    /// let plan = Doser::new(&pump, Limits::new(motor))?.plan(Phase::known(0.3), &request)?;
    /// let way = plan.stop_at(2.5);
    /// assert_eq!((way.angle_rad, way.speed_rad_s), (plan.angle_at(2.5), plan.speed_at(2.5)));
    /// assert!(way.speed_at(way.end_s()).abs() < 1e-9 && way.end_angle_rad() < plan.end_angle_rad());
    /// # Ok::<(), pump_ctl::plan::PlanError>(())
    /// ```
    pub fn stop_at(&self, t_s: f64) -> Leg {
        let start_s = t_s.max(0.0).min(self.profile.duration_s());
        let speed_rad_s = self.speed_at(start_s);
        let deceleration_rad_s2 = self.profile.acceleration_rad_s2();
        Leg {
            start_s,
            duration_s: speed_rad_s.abs() / deceleration_rad_s2,
            angle_rad: self.angle_at(start_s),
            speed_rad_s,
            acceleration_rad_s2: -deceleration_rad_s2 * f64::from(self.direction().sign()),
        }
    }

    /// Returns the speed `t_s` after the start of motion, rad/s, negative in reverse. It is 0 before and
    /// after the motion.
    pub fn speed_at(&self, t_s: f64) -> f64 {
        let moves = (0.0..self.profile.duration_s()).contains(&t_s);
        if moves { self.profile.leg_at(t_s).speed_at(t_s) } else { 0.0 }
    }
}
