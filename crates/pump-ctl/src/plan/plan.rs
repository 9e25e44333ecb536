//! A dose, ready to run.

use super::line_states::LineStates;
use super::profile::{Legs, Profile};
use super::words::{Finish, LimitedBy, Phase};

/// A dose, ready to run. [`crate::plan::plan`] makes it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Plan {
    /// Volume that was asked for, mL; negative in reverse.
    pub requested_ml: f64,
    /// Carry of earlier doses, mL.
    pub carry_in_ml: f64,
    /// Volume of the planned steps once the line has settled, mL. A start angle that is not known exactly gives a
    /// range of volumes, and this is its middle.
    pub planned_ml: f64,
    /// Smallest volume that the planned steps deliver from an angle at which the rollers may stand, mL. It equals
    /// `planned_ml` if the angle is known exactly; in reverse it is the one farther from zero.
    pub least_ml: f64,
    /// Largest volume that the planned steps deliver from an angle at which the rollers may stand, mL.
    pub most_ml: f64,
    /// Carry to the next dose, mL: requested + carry_in - planned.
    pub carry_ml: f64,
    /// Where in a pitch the dose may end.
    pub finish: Finish,
    /// Angle of the rollers at the start.
    pub start: Phase,
    /// Motor steps; negative in reverse.
    pub steps: i64,
    /// Steps per revolution of the pump head.
    pub steps_per_rev: f64,
    /// Angle of a step, rad.
    pub step_rad: f64,
    /// Speed over time.
    pub profile: Profile,
    /// Limit that keeps the cruise speed down.
    pub limited_by: LimitedBy,
    /// Volume that the dose had delivered when this plan took over, mL; 0 unless [`Self::retarget`] made it.
    pub before_ml: f64,
    /// Inlet and outlet line at the start.
    pub(super) lines: LineStates,
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

    /// Speed of the pump head when `count` steps are made, rad/s, not negative.
    pub fn speed_after(&self, count: u64) -> f64 {
        self.profile.speed_at(count as f64 * self.step_rad)
    }

    /// The motion as legs: ramp, cruise, ramp; then the motor holds.
    pub fn legs(&self) -> Legs<'_> {
        self.profile.legs()
    }

    /// Angle `t_s` after the start of motion, rad, of the smooth motion through the steps.
    ///
    /// Before the motion it is the start angle, after it the end angle. It serves drives that take set-points instead
    /// of steps.
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

    /// Speed `t_s` after the start of motion, rad/s, negative in reverse; 0 before and after the motion.
    pub fn speed_at(&self, t_s: f64) -> f64 {
        let moves = (0.0..self.profile.duration_s()).contains(&t_s);
        if moves { self.profile.leg_at(t_s).speed_at(t_s) } else { 0.0 }
    }
}
