//! From a volume to a motion: angle, speed profile, step times, predicted pressures.

mod brake;
mod cruise;
mod envelope;
mod error;
mod fastest;
mod finish;
mod legs;
mod limits;
mod lines;
mod margins;
mod motion;
mod phase;
mod prediction;
mod profile;
mod request;
mod retarget;
mod ripple;
mod segments;
mod smooth;
mod steps;
mod target;
mod torque;
mod turn;

pub use cruise::speed_for_flow;
pub use error::{Nearest, PlanError};
pub use finish::Finish;
pub use legs::Legs;
pub use limits::{Limits, Lowest, Motor, SetBy};
pub use margins::{Margin, Margins};
pub use phase::Phase;
pub use prediction::Prediction;
pub use profile::Profile;
pub use request::{Cruise, Request};
pub use ripple::Ripples;
pub use segments::Segments;
pub use steps::{Step, Steps};
pub use torque::{TORQUE_POINTS, Torque, TorqueCurve};
pub use turn::turn;

use lines::Lines;
use profile::{Course, SpeedLimit};
use pump_model::Pump;
use target::{Target, delivered, middle};

/// What keeps a dose from being faster.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum LimitedBy {
    /// It cruises at the speed that was asked for.
    Nothing,
    /// The dose is too short to reach that speed, or the envelope of a smooth flow, within the acceleration limit.
    Acceleration,
    /// The motor's largest speed.
    Speed,
    /// The pressure at the port that pushes.
    OutletPressure,
    /// The pressure at the port that sucks.
    InletPressure,
    /// Too little pressure at the port that pushes, as a long line makes where the flow falls.
    OutletSuction,
    /// The torque that the motor has.
    Torque,
}

/// A dose, ready to run: made by [`plan`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Plan {
    /// Volume asked for, mL; negative in reverse.
    pub requested_ml: f64,
    /// What earlier doses owed, mL.
    pub carry_in_ml: f64,
    /// Volume of the planned steps once the line has settled, mL; of a start angle that is not known exactly, the middle of
    /// what it may be.
    pub planned_ml: f64,
    /// Smallest volume that the planned steps deliver from an angle at which the rollers may stand, mL; `planned_ml` if the
    /// angle is known exactly. In reverse it is the one farther from zero.
    pub least_ml: f64,
    /// Largest such volume, mL.
    pub most_ml: f64,
    /// What the next dose owes: requested + carry_in - planned, mL.
    pub carry_ml: f64,
    /// Where in a pitch it may end.
    pub finish: Finish,
    /// Where the rollers stand at the start.
    pub start: Phase,
    /// Motor steps; negative in reverse.
    pub steps: i64,
    /// Steps per revolution of the pump head.
    pub steps_per_rev: f64,
    /// Angle of a step, rad.
    pub step_rad: f64,
    /// Speed over time.
    pub profile: Profile,
    /// What keeps the cruise speed down.
    pub limited_by: LimitedBy,
    /// Volume that this dose had delivered when this plan took over, mL; 0 unless [`Self::retarget`] made it.
    pub before_ml: f64,
    /// Inlet and outlet line at the start.
    lines: Lines,
}

/// Plans a dose: the steps whose volume is nearest to what is asked, and the fastest profile that the request and the
/// limits allow. Steps and end angle do not depend on the speed.
///
/// The angle solves V_out(theta_1) = V_out(theta_0) + V for the outlet's exact volume curve, so the dose is right from
/// any start angle. Of an angle that is not known exactly the steps are those whose worst deviation over all the angles that
/// it may be is smallest (minimax), and [`Plan::least_ml`] and [`Plan::most_ml`] say between which volumes they deliver;
/// whole pitches deliver the same from anywhere.
///
/// Where the dose must end at low flow ([`Finish::LowFlow`]) the steps are those of the allowed end whose volume is nearest,
/// and the difference is carried; an end farther from what is owed than not moving at all is refused.
///
/// A smooth flow changes when each step is made, and neither how many there are nor where they end. Where the angle is so
/// uncertain that it could be less smooth than at constant speed, it is refused.
///
/// Where a pressure or torque limit is given the whole dose is predicted, and one that breaks it is refused with the nearest
/// that holds them all, from wherever the rollers may stand.
pub fn plan(pump: &Pump, start: Phase, request: &Request, limits: &Limits) -> Result<Plan, PlanError> {
    limits.validate()?;
    request.validate()?;
    start.validate()?;
    let target = target::nearest_steps(pump, start, request, limits.motor.step_rad())?;
    fastest(
        pump,
        Start { phase: start, speed_rad_s: 0.0, before_ml: 0.0, lines: Lines::AT_REST },
        target,
        request,
        limits,
    )
}

/// What a plan goes on from.
struct Start {
    phase: Phase,
    speed_rad_s: f64,
    before_ml: f64,
    lines: Lines,
}

/// The fastest plan that makes the steps of `target` within what the request and the limits allow.
fn fastest(
    pump: &Pump,
    start: Start,
    target: Target,
    request: &Request,
    limits: &Limits,
) -> Result<Plan, PlanError> {
    let at_speed = |cruise_rad_s: f64| {
        let Motor { max_speed_rad_s, max_acceleration_rad_s2, .. } = limits.motor;
        let direction = if target.steps < 0 { -1 } else { 1 };
        let curve = pump.outlet_curve();
        let limit = if request.smooth {
            let flow_ml_s = smooth::flow_limit_ml_s(
                curve,
                direction,
                cruise_rad_s,
                max_speed_rad_s,
                max_acceleration_rad_s2,
            );
            SpeedLimit::Smooth { flow_ml_s, max_rad_s: max_speed_rad_s }
        } else {
            SpeedLimit::Constant { rad_s: cruise_rad_s }
        };
        let course = Course {
            start_rad: start.phase.angle_rad,
            direction,
            start_rad_s: start.speed_rad_s,
            turn_rad: target.steps.unsigned_abs() as f64 * limits.motor.step_rad(),
            acceleration_rad_s2: max_acceleration_rad_s2,
            limit,
        };
        let profile = Profile::new(course, curve);
        Plan {
            requested_ml: request.volume_ml,
            carry_in_ml: request.carry_in_ml,
            planned_ml: target.planned_ml,
            least_ml: target.range_ml.0,
            most_ml: target.range_ml.1,
            carry_ml: request.owed_ml() - target.planned_ml,
            finish: request.finish,
            start: start.phase,
            steps: target.steps,
            steps_per_rev: limits.motor.steps_per_rev,
            step_rad: limits.motor.step_rad(),
            profile,
            limited_by: if profile.reaches_limit() { LimitedBy::Nothing } else { LimitedBy::Acceleration },
            before_ml: start.before_ml,
            lines: start.lines,
        }
    };
    let planned = cruise::choose(pump, request.cruise, limits, at_speed)?;
    planned.check_ripples(pump)?;
    Ok(planned)
}

impl Plan {
    /// 1 forward, -1 in reverse.
    pub fn direction(&self) -> i8 {
        if self.steps < 0 { -1 } else { 1 }
    }

    /// Angle at the end, rad, counted on from the start angle.
    pub fn end_angle_rad(&self) -> f64 {
        self.angle_after(self.steps.unsigned_abs())
    }

    /// Angle after `count` steps, rad.
    pub fn angle_after(&self, count: u64) -> f64 {
        self.start.angle_rad + f64::from(self.direction()) * (count as f64 * self.step_rad)
    }

    /// Volume of the first `count` steps once the line has settled, mL; negative in reverse. The middle of
    /// [`Self::range_ml`].
    pub fn delivered_ml(&self, pump: &Pump, count: u64) -> f64 {
        middle(self.range_ml(pump, count))
    }

    /// Smallest and largest volume of the first `count` steps from an angle at which the rollers may stand, mL; a single
    /// one if the angle is known exactly.
    pub fn range_ml(&self, pump: &Pump, count: u64) -> (f64, f64) {
        let steps = f64::from(self.direction()) * count as f64;
        delivered(pump, self.start, steps, self.step_rad)
    }

    /// Angle `t_s` after the start of motion, rad, of the smooth motion through the steps; the start angle before it, the
    /// end angle after it. For a drive that takes set-points instead of steps.
    ///
    /// ```
    /// use pump_ctl::plan::{Cruise, Limits, Motor, Phase, Request, plan};
    /// let motor = Motor { steps_per_rev: 12_800.0, max_speed_rad_s: 17.8, max_acceleration_rad_s2: 500.0 };
    /// let request = Request::new(25.0, Cruise::Flow { ml_s: 5.0 });
    /// let plan = plan(&pump_model::Pump::three_roller(), Phase::known(0.3), &request, &Limits::of_motor(motor))?;
    /// assert_eq!(plan.angle_at(-1.0), 0.3);
    /// let step = plan.steps().nth(5000).unwrap();
    /// assert!((plan.angle_at(step.time_s) - step.angle_rad).abs() < 1e-9);
    /// assert!((plan.angle_at(60.0) - plan.end_angle_rad()).abs() < 1e-9);
    /// # Ok::<(), pump_ctl::plan::PlanError>(())
    /// ```
    pub fn angle_at(&self, t_s: f64) -> f64 {
        let t_s = t_s.max(0.0).min(self.profile.duration_s());
        self.profile.leg_at(t_s).angle_at(t_s)
    }

    /// Speed `t_s` after the start of motion, rad/s, negative in reverse; 0 before and after it.
    pub fn speed_at(&self, t_s: f64) -> f64 {
        let moves = (0.0..self.profile.duration_s()).contains(&t_s);
        if moves { self.profile.leg_at(t_s).speed_at(t_s) } else { 0.0 }
    }

    /// Every step with its time.
    pub fn steps(&self) -> Steps<'_> {
        Steps::new(self)
    }

    /// Volume that the step containing the end of the dose delivers, mL: the resolution there.
    pub fn end_step_ml(&self, pump: &Pump) -> f64 {
        pump.outlet_curve().flow_ml_rad(self.end_angle_rad()) * self.step_rad
    }
}
