//! The state from which a move goes on, and the plan of the move.

use pump_model::Pump;

use super::in_time::InTime;
use crate::plan::Plan;
use crate::plan::limits::{Limits, Motor};
use crate::plan::line_states::LineStates;
use crate::plan::profile::{Course, Profile, Shape, SmoothLimit, SpeedLimit};
use crate::plan::ramps::{Grid, line_aware};
use crate::plan::speed::choose;
use crate::plan::target::Target;
use crate::plan::words::{Cruise, LimitedBy, Phase, PlanError, Ramps, Request, Turned};

/// Part of the motor's largest speed from which on a speed is the largest.
const NEARLY: f64 = 1.0 - 1e-9;

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

    /// Makes the plan of the steps of `target` that the request and the limits allow, with the ramps that it
    /// asks for.
    ///
    /// The speed is chosen with usual ramps. The ramps of the dose itself are sought at that speed, and kept if
    /// they hold every limit. A time that is asked for has a search of its own.
    pub(super) fn plan(
        &self,
        pump: &Pump,
        target: &Target,
        request: &Request,
        limits: &Limits,
    ) -> Result<Plan, PlanError> {
        if let (Cruise::Within { time_s }, Ramps::LineAware) = (request.cruise, request.ramps) {
            return InTime { start: self, pump, target, request, limits, time_s }.plan();
        }
        let usual = |course: &Course, cruise_rad_s: f64| match request.ramps {
            Ramps::LineAware => Grid::new(pump.outlet(), course, cruise_rad_s).usual(),
            Ramps::Fastest => None,
        };
        let at_speed = |cruise_rad_s: f64| {
            self.plan_at_speed(pump, target, request, &limits.motor, cruise_rad_s, &usual)
        };
        // A wider angle gets the usual ramps, which suit most doses from any angle.
        let is_sought = request.ramps == Ramps::LineAware && self.phase.is_stated();
        let planned = match choose(pump, request.cruise, limits, at_speed) {
            Ok(planned) => planned,
            Err(refused) => {
                // A dose whose usual ramps break a limit may hold it with its own.
                let is_given = matches!(request.cruise, Cruise::Flow { .. } | Cruise::Speed { .. });
                if !(is_sought && is_given && limits.are_predicted()) {
                    return Err(refused);
                }
                let free = choose(pump, request.cruise, &Limits::new(limits.motor), at_speed)?;
                free.check_ripples(pump)?;
                return own_ramps(pump, free, request, limits).ok_or(refused);
            }
        };
        planned.check_ripples(pump)?;
        if !is_sought {
            return Ok(planned);
        }
        let own = own_ramps(pump, planned.clone(), request, limits);
        Ok(own.unwrap_or(planned))
    }

    /// Makes the plan of the steps of `target` with ramps of this shape.
    pub(super) fn plan_with_shape(
        &self,
        pump: &Pump,
        target: &Target,
        request: &Request,
        limits: &Limits,
        shape: Option<Shape>,
    ) -> Result<Plan, PlanError> {
        let at_speed = |cruise_rad_s: f64| {
            self.plan_at_speed(pump, target, request, &limits.motor, cruise_rad_s, &|_, _| shape)
        };
        choose(pump, request.cruise, limits, at_speed)
    }

    /// Makes the plan at a cruise speed, without regard to pressures and torque.
    pub(super) fn plan_at_speed(
        &self,
        pump: &Pump,
        target: &Target,
        request: &Request,
        motor: &Motor,
        cruise_rad_s: f64,
        shape: &impl Fn(&Course, f64) -> Option<Shape>,
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
            shape: None,
        };
        let course = Course { shape: shape(&course, cruise_rad_s), ..course };
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
            ramps: request.ramps,
            is_hurried: false,
            limited_by: if profile.reaches_limit() { LimitedBy::Nothing } else { LimitedBy::Acceleration },
            before_ml: self.before_ml,
            lines: self.lines,
        }
    }
}

/// Returns `usual` with the ramps that are best for itself. `None` if they break a limit.
fn own_ramps(pump: &Pump, usual: Plan, request: &Request, limits: &Limits) -> Option<Plan> {
    let shape = line_aware(pump, &usual)?;
    let profile = usual.profile.with_shape(Some(shape));
    let limited_by = match usual.limited_by {
        LimitedBy::Nothing | LimitedBy::Speed if !profile.reaches_limit() => LimitedBy::Acceleration,
        LimitedBy::Acceleration if profile.reaches_limit() => match request.cruise {
            // The search ends at the speed that a short dose reaches, which is no limit of the motor.
            Cruise::Fastest if profile.peak_rad_s() < NEARLY * limits.motor.max_speed_rad_s => {
                LimitedBy::Acceleration
            }
            Cruise::Fastest => LimitedBy::Speed,
            _ => LimitedBy::Nothing,
        },
        other => other,
    };
    let own = Plan { profile, limited_by, ..usual };
    limits.broken(pump, &own).is_none().then_some(own)
}
