//! The way to rest in the midst of a plan.

use libm::ceil;
use pump_model::Pump;

use crate::plan::Plan;
use crate::plan::line_states::LineStates;
use crate::plan::profile::{Course, Profile, SpeedLimit};
use crate::plan::target::delivered;
use crate::plan::words::{LimitedBy, Turned};

impl Plan {
    /// Returns the states in which this plan leaves the lines when `made` steps are made. If the start angle
    /// is not known exactly, the states before this plan are those of its middle.
    pub(super) fn lines_at(&self, pump: &Pump, made: u64) -> LineStates {
        let time_s = self.profile.time_of(made as f64 * self.step_rad);
        LineStates::After { were: self.lines.states(pump, 0.0), course: self.profile.course, time_s }
    }

    /// Returns the fewest steps that the rotor needs to stop once `made` steps are made.
    pub(in crate::plan) fn stopping_steps(&self, made: u64, acceleration_rad_s2: f64) -> i64 {
        let speed_rad_s = self.speed_after(made);
        let stopping_rad = speed_rad_s * speed_rad_s / (2.0 * acceleration_rad_s2);
        // A dose that is stopped on its last ramp needs just the steps that are left, up to rounding.
        ceil(stopping_rad / self.step_rad - 1e-6) as i64
    }

    /// Plans the way to rest from the moment at which `made` steps are made, at the motor's largest acceleration.
    /// It makes no more steps than the plan. The result is `None` if the rotor stands at that moment.
    ///
    /// The returned plan has time 0, start angle, volumes and steps of its own, as that of
    /// [`crate::plan::Doser::retarget`].
    pub fn stop(&self, pump: &Pump, made: u64) -> Option<Self> {
        let left = self.steps.unsigned_abs().checked_sub(made).filter(|left| *left > 0)?;
        let speed_rad_s = self.speed_after(made);
        let acceleration_rad_s2 = self.profile.acceleration_rad_s2();
        let steps = self.stopping_steps(made, acceleration_rad_s2).unsigned_abs().min(left);
        if steps == 0 {
            return None;
        }
        let start = self.start.moved_to(self.angle_after(made));
        let volume_ml = self.delivered_ml(pump, made + steps) - self.delivered_ml(pump, made);
        let range_ml = if start.half_width_rad == 0.0 {
            (volume_ml, volume_ml)
        } else {
            delivered(pump, start, f64::from(self.direction().sign()) * steps as f64, self.step_rad)
        };
        let course = Course {
            start_rad: start.angle_rad,
            start_rad_s: speed_rad_s,
            turn_rad: steps as f64 * self.step_rad,
            limit: SpeedLimit::Constant { rad_s: speed_rad_s },
            shape: None,
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
            turned: if self.turned.is_exact() { Turned::at(start) } else { self.turned_after(made) },
            steps: i64::from(self.direction().sign()) * steps as i64,
            profile: Profile::new(course, pump.outlet_curve()),
            limited_by: LimitedBy::Nothing,
            before_ml: self.before_ml + self.delivered_ml(pump, made),
            lines: self.lines_at(pump, made),
            ..*self
        })
    }
}
