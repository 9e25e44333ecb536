//! The plan: a dose, ready to run.

use super::line_states::LineStates;
use super::profile::{Legs, Profile};
use super::words::{Finish, LimitedBy, Phase};

/// A dose, ready to run. [`crate::plan::plan()`] makes it.
///
/// ```
/// use pump_ctl::plan::{Cruise, Limits, Motor, Phase, Request, plan};
///
/// let pump = pump_model::Pump::three_roller();
/// let motor = Motor { steps_per_rev: 12_800.0, max_speed_rad_s: 17.8, max_acceleration_rad_s2: 500.0 };
/// let request = Request::new(25.0, Cruise::Flow { ml_s: 5.0 });
/// let plan = plan(&pump, Phase::known(0.0), &request, &Limits::of_motor(motor))?;
/// assert_eq!((plan.steps, plan.direction()), (15_480, 1));
/// assert!((plan.profile.duration_s() - 5.16).abs() < 0.01);
/// assert!(plan.predict(&pump)?.outlet.max_kpa > pump.outlet().reservoir_kpa);
/// # Ok::<(), pump_ctl::plan::PlanError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Plan {
    /// Volume asked for, mL. Negative in reverse.
    pub requested_ml: f64,
    /// Carry of earlier doses, mL.
    pub carry_in_ml: f64,
    /// Volume of the planned steps once the line has settled, mL. It is the middle of the range if the start
    /// angle is not known exactly.
    pub planned_ml: f64,
    /// Smallest volume that the planned steps deliver from an angle at which the rollers may stand, mL. It
    /// equals `planned_ml` if the angle is known exactly. In reverse it is farther from zero than `most_ml`.
    pub least_ml: f64,
    /// Largest volume that the planned steps deliver from an angle at which the rollers may stand, mL.
    pub most_ml: f64,
    /// Carry to the next dose, mL: requested + carry_in - planned.
    pub carry_ml: f64,
    /// Place in a pitch at which the dose may end.
    pub finish: Finish,
    /// Angle of the rollers at the start.
    pub start: Phase,
    /// Number of motor steps. Negative in reverse.
    pub steps: i64,
    /// Steps per revolution of the pump head.
    pub steps_per_rev: f64,
    /// Angle of a step, rad.
    pub step_rad: f64,
    /// Speed of the pump head over time.
    pub profile: Profile,
    /// Limit that keeps the cruise speed down.
    pub limited_by: LimitedBy,
    /// Volume that the dose had delivered when this plan took over, mL. It is 0 unless [`Self::retarget`] or
    /// [`Self::stop`] made the plan.
    pub before_ml: f64,
    /// States of inlet and outlet line at the start.
    pub(super) lines: LineStates,
}

impl Plan {
    /// Returns the direction: 1 forward, -1 in reverse.
    pub fn direction(&self) -> i8 {
        if self.steps < 0 { -1 } else { 1 }
    }

    /// Returns the angle at the end, rad, counted on from the start angle.
    pub fn end_angle_rad(&self) -> f64 {
        self.angle_after(self.steps.unsigned_abs())
    }

    /// Returns the angle after `count` steps, rad, counted on from the start angle.
    pub fn angle_after(&self, count: u64) -> f64 {
        self.start.angle_rad + f64::from(self.direction()) * (count as f64 * self.step_rad)
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
    /// use pump_ctl::plan::{Cruise, Limits, Motor, Phase, Request, plan};
    ///
    /// let pump = pump_model::Pump::three_roller();
    /// let motor = Motor { steps_per_rev: 12_800.0, max_speed_rad_s: 17.8, max_acceleration_rad_s2: 500.0 };
    /// let request = Request::new(25.0, Cruise::Flow { ml_s: 5.0 });
    /// let plan = plan(&pump, Phase::known(0.3), &request, &Limits::of_motor(motor))?;
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

    /// Returns the speed `t_s` after the start of motion, rad/s, negative in reverse. It is 0 before and
    /// after the motion.
    pub fn speed_at(&self, t_s: f64) -> f64 {
        let moves = (0.0..self.profile.duration_s()).contains(&t_s);
        if moves { self.profile.leg_at(t_s).speed_at(t_s) } else { 0.0 }
    }
}
