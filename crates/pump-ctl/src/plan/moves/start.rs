//! The state from which a move goes on, and the plan of the move.

use pump_model::Pump;

use crate::plan::Plan;
use crate::plan::limits::{Limits, Motor};
use crate::plan::line_states::LineStates;
use crate::plan::profile::{Course, Profile, SmoothLimit, SpeedLimit};
use crate::plan::speed::choose;
use crate::plan::target::Target;
use crate::plan::words::{LimitedBy, Phase, PlanError, Request, Turned};

/// The state of rotor and lines from which a move goes on.
pub(super) struct Start {
    /// Angle of the rollers.
    pub(super) phase: Phase,
    /// Speed of the rotor, rad/s, not negative.
    pub(super) speed_rad_s: f64,
    /// Volume that the dose has delivered before, mL.
    pub(super) before_ml: f64,
    /// States of inlet and outlet line.
    pub(super) lines: LineStates,
}

impl Start {
    /// Makes the state of a rotor and lines at rest.
    pub(super) fn at_rest(phase: Phase) -> Self {
        Self { phase, speed_rad_s: 0.0, before_ml: 0.0, lines: LineStates::AT_REST }
    }

    /// Makes the fastest plan of the steps of `target` that the request and the limits allow.
    pub(super) fn plan(
        &self,
        pump: &Pump,
        target: &Target,
        request: &Request,
        limits: &Limits,
    ) -> Result<Plan, PlanError> {
        let at_speed =
            |cruise_rad_s: f64| self.plan_at_speed(pump, target, request, &limits.motor, cruise_rad_s);
        let planned = choose(pump, request.cruise, limits, at_speed);
        // A plan takes 1.4 kB. It is checked where it lies, as each move of it costs 1,200 instructions.
        if let Ok(plan) = &planned {
            plan.check_ripples(pump)?;
        }
        planned
    }

    /// Makes the plan at a cruise speed, without regard to pressures and torque.
    fn plan_at_speed(
        &self,
        pump: &Pump,
        target: &Target,
        request: &Request,
        motor: &Motor,
        cruise_rad_s: f64,
    ) -> Plan {
        let curve = pump.outlet_curve();
        let direction = if target.steps < 0 { -1 } else { 1 };
        let (max_rad_s, acceleration_rad_s2) = (motor.max_speed_rad_s, motor.max_acceleration_rad_s2);
        let limit = if request.smooth {
            let limit = SmoothLimit::new(pump, direction, cruise_rad_s, max_rad_s, acceleration_rad_s2);
            SpeedLimit::Smooth(limit)
        } else {
            SpeedLimit::Constant { rad_s: cruise_rad_s }
        };
        let course = Course {
            start_rad: self.phase.angle_rad,
            direction,
            start_rad_s: self.speed_rad_s,
            turn_rad: target.steps.unsigned_abs() as f64 * motor.step_rad(),
            acceleration_rad_s2,
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
            start: self.phase,
            turned: request.turned.unwrap_or(Turned::at(self.phase)),
            steps: target.steps,
            steps_per_rev: motor.steps_per_rev,
            step_rad: motor.step_rad(),
            profile,
            limited_by: if profile.reaches_limit() { LimitedBy::Nothing } else { LimitedBy::Acceleration },
            before_ml: self.before_ml,
            lines: self.lines,
        }
    }
}
