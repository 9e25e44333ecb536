//! The way to rest in the midst of a flow over time.

use libm::ceil;
use pump_model::{ExactRun, LineState, Port, Pump};

use super::motion::FlowMotion;
use crate::plan::Plan;
use crate::plan::line_states::LineStates;
use crate::plan::profile::{Course, Profile, SpeedLimit};
use crate::plan::words::{Finish, LimitedBy, Ramps, Turned};

impl FlowMotion<'_> {
    /// Returns the fewest steps in which the rotor stops once `made` steps are made. They are no more than the flow
    /// has left.
    pub fn stopping_steps(&self, made: u64) -> u64 {
        let speed_rad_s = self.speed_after(made);
        let stopping_rad = speed_rad_s * speed_rad_s / (2.0 * self.acceleration_rad_s2());
        let steps = ceil(stopping_rad / self.step_rad() - 1e-6) as u64;
        steps.min(self.all().saturating_sub(made))
    }

    /// Plans the way to rest from the moment at which `made` steps are made, at the motor's largest acceleration, as
    /// [`Plan::stop`] does. The result is `None` if the rotor stands at that moment.
    pub fn stop(&self, pump: &Pump, made: u64) -> Option<Plan> {
        let steps = Some(self.stopping_steps(made)).filter(|steps| *steps > 0)?;
        let speed_rad_s = self.speed_after(made);
        let curve = pump.outlet_curve();
        let start = self.start.moved_to(self.angle_after(made));
        let volume_ml = curve.volume_ml(self.angle_after(made + steps)) - curve.volume_ml(start.angle_rad);
        let time_s = self.time_of(made);
        let state = |port| ExactRun::new(pump, port, self.legs(), LineState::AT_REST).at(time_s);
        let course = Course {
            start_rad: start.angle_rad,
            direction: self.direction.sign(),
            start_rad_s: speed_rad_s,
            turn_rad: steps as f64 * self.step_rad(),
            acceleration_rad_s2: self.acceleration_rad_s2(),
            limit: SpeedLimit::Constant { rad_s: speed_rad_s },
            shape: None,
        };
        Some(Plan {
            requested_ml: volume_ml,
            carry_in_ml: 0.0,
            planned_ml: volume_ml,
            least_ml: volume_ml,
            most_ml: volume_ml,
            carry_ml: 0.0,
            finish: Finish::Any,
            start,
            turned: Turned::at(start),
            steps: i64::from(self.direction.sign()) * steps as i64,
            steps_per_rev: self.motor.steps_per_rev,
            step_rad: self.step_rad(),
            profile: Profile::new(course, curve),
            ramps: Ramps::Fastest,
            is_hurried: false,
            limited_by: LimitedBy::Nothing,
            before_ml: curve.volume_ml(start.angle_rad) - curve.volume_ml(self.start.angle_rad),
            lines: LineStates::Known([state(Port::Inlet), state(Port::Outlet)]),
        })
    }
}
