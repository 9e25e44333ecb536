//! Another volume or another rate in the midst of a dose.

use pump_model::Pump;
use pump_model::math::ceil;

use super::lines::Lines;
use super::profile::{Course, Profile, SpeedLimit};
use super::request::Request;
use super::target::{delivered, middle, nearest_steps};
use super::{Cruise, LimitedBy, Limits, Phase, Plan, PlanError, Start, fastest};

impl Plan {
    /// Speed of the pump head when `count` steps are made, rad/s, not negative.
    pub fn speed_after(&self, count: u64) -> f64 {
        self.profile.speed_at(count as f64 * self.step_rad)
    }

    /// Plans the rest of this dose anew from the moment at which `made` steps are made: `volume_ml` for the whole dose,
    /// counted from its start, `cruise` for the rest of it (a time counts from that moment). A smooth flow stays smooth, and a dose
    /// that ends at low flow ends at low flow; where the rotor cannot stop at the end nearest to the new volume any more, it is
    /// refused.
    ///
    /// The plan that comes back has time 0, start angle, volumes and steps of the rest alone: its `requested_ml` is what
    /// was still to be delivered, `before_ml` what was delivered before, its carry that of the whole dose; where the start
    /// angle is not known exactly, what is delivered counts by its middle, and the range of the rest is its own. It starts
    /// at speed, with the lines as this plan leaves them. Feed its segments after the [`crate::step::Junction`] at position
    /// `made`. The motor's steps must be the same.
    ///
    /// ```
    /// # use pump_ctl::plan::{Cruise, Limits, Motor, Phase, Request, plan};
    /// # let motor = Motor { steps_per_rev: 12_800.0, max_speed_rad_s: 17.8, max_acceleration_rad_s2: 500.0 };
    /// # let (pump, limits) = (pump_model::Pump::three_roller(), Limits::of_motor(motor));
    /// let slow = Cruise::Flow { ml_s: 5.0 };
    /// let whole = plan(&pump, Phase::known(0.3), &Request::new(25.0, slow), &limits)?;
    /// let rest = whole.retarget(&pump, 6000, 30.0, Cruise::Flow { ml_s: 10.0 }, &limits)?;
    /// let delivered_ml = whole.delivered_ml(&pump, 6000) + rest.planned_ml;
    /// assert!((delivered_ml - 30.0).abs() < 0.001);
    /// # Ok::<(), pump_ctl::plan::PlanError>(())
    /// ```
    pub fn retarget(
        &self,
        pump: &Pump,
        made: u64,
        volume_ml: f64,
        cruise: Cruise,
        limits: &Limits,
    ) -> Result<Self, PlanError> {
        self.retarget_shaped(pump, made, volume_ml, cruise, self.is_smooth(), limits)
    }

    /// [`Self::retarget`], from here on with a smooth flow or at constant speed.
    pub fn retarget_shaped(
        &self,
        pump: &Pump,
        made: u64,
        volume_ml: f64,
        cruise: Cruise,
        smooth: bool,
        limits: &Limits,
    ) -> Result<Self, PlanError> {
        let steps = self.steps.unsigned_abs();
        if made >= steps {
            return Err(PlanError::NoSuchStep { made, steps });
        }
        limits.validate()?;
        let carry_in_ml = self.carry_in_ml;
        let finish = self.finish;
        Request { volume_ml, carry_in_ml, cruise, smooth, finish }.validate()?;
        if limits.motor.step_rad() != self.step_rad {
            return Err(PlanError::OutOfRange {
                parameter: "steps per revolution of a dose under way",
                value: limits.motor.steps_per_rev,
                allowed: "those that it was planned with",
            });
        }
        let delivered_ml = self.before_ml + self.delivered_ml(pump, made);
        let request = Request { volume_ml: volume_ml - delivered_ml, carry_in_ml, cruise, smooth, finish };

        let phase = Phase { angle_rad: self.angle_after(made), ..self.start };
        let speed_rad_s = self.speed_after(made);
        let target = nearest_steps(pump, phase, &request, self.step_rad);
        let stopping = self.stopping_steps(made, limits.motor.max_acceleration_rad_s2).max(1);
        let too_few = match &target {
            Ok(target) => target.steps * i64::from(self.direction()) < stopping,
            // Nothing is left to deliver, but the rotor turns.
            Err(PlanError::LessThanHalfAStep { .. }) => true,
            Err(_) => false,
        };
        if too_few {
            let stands = made.saturating_add_signed(stopping);
            let nearest_ml = self.before_ml + self.delivered_ml(pump, stands);
            return Err(PlanError::CannotStopThere { asked_ml: volume_ml, delivered_ml, nearest_ml });
        }
        let mut lines = self.lines_at(pump, made);
        let needed = limits.are_predicted() || matches!(cruise, Cruise::Within { .. } | Cruise::Fastest);
        if needed && phase.half_width_rad == 0.0 {
            // Needed at once, and at every speed that is tried.
            lines = Lines::Are(lines.states(pump, 0.0));
        }
        fastest(pump, Start { phase, speed_rad_s, before_ml: delivered_ml, lines }, target?, &request, limits)
    }

    /// Steps that the rotor makes at least once `made` are made, if it is to stop.
    fn stopping_steps(&self, made: u64, acceleration_rad_s2: f64) -> i64 {
        let speed_rad_s = self.speed_after(made);
        let stopping_rad = speed_rad_s * speed_rad_s / (2.0 * acceleration_rad_s2);
        // A dose stopped at its own end needs, up to rounding, just the steps that are left.
        ceil(stopping_rad / self.step_rad - 1e-6) as i64
    }

    /// The way to rest from the moment at which `made` steps are made, at the plan's own acceleration; it makes no more
    /// steps than the plan. `None` if the rotor stands then.
    ///
    /// Like the plan of [`Self::retarget`] it has time 0, start angle, volumes and steps of its own.
    pub fn stop(&self, pump: &Pump, made: u64) -> Option<Self> {
        let left = self.steps.unsigned_abs().checked_sub(made).filter(|left| *left > 0)?;
        let speed_rad_s = self.speed_after(made);
        let acceleration_rad_s2 = self.profile.acceleration_rad_s2();
        let steps = self.stopping_steps(made, acceleration_rad_s2).unsigned_abs().min(left);
        if steps == 0 {
            return None;
        }
        let start = Phase { angle_rad: self.angle_after(made), ..self.start };
        let range_ml = if start.half_width_rad == 0.0 {
            let volume_ml = self.delivered_ml(pump, made + steps) - self.delivered_ml(pump, made);
            (volume_ml, volume_ml)
        } else {
            delivered(pump, start, f64::from(self.direction()) * steps as f64, self.step_rad)
        };
        let volume_ml = middle(range_ml);
        let course = Course {
            start_rad: start.angle_rad,
            start_rad_s: speed_rad_s,
            turn_rad: steps as f64 * self.step_rad,
            limit: SpeedLimit::Constant { rad_s: speed_rad_s },
            ..self.profile.course
        };
        Some(Self {
            requested_ml: volume_ml,
            carry_in_ml: 0.0,
            planned_ml: volume_ml,
            least_ml: range_ml.0,
            most_ml: range_ml.1,
            carry_ml: 0.0,
            start,
            steps: i64::from(self.direction()) * steps as i64,
            profile: Profile::new(course, pump.outlet_curve()),
            limited_by: LimitedBy::Nothing,
            before_ml: self.before_ml + self.delivered_ml(pump, made),
            lines: self.lines_at(pump, made),
            ..*self
        })
    }
}
