//! A dose from rest.

use pump_model::Pump;

use super::start::Start;
use crate::plan::Plan;
use crate::plan::limits::Limits;
use crate::plan::target::nearest_steps;
use crate::plan::words::{Phase, PlanError, Request};

/// Plans a dose. Its steps are those whose volume is nearest to the volume requested plus carried.
///
/// The profile is the fastest that the request and the limits allow. Steps and end angle do not depend on the
/// speed.
///
/// The angle solves V_out(theta_1) = V_out(theta_0) + V for the outlet's exact volume curve, so the dose is
/// right from any start angle. If the start angle is not known exactly, the steps minimise the worst
/// deviation over all angles at which the rollers may stand (minimax). [`Plan::least_ml`] and
/// [`Plan::most_ml`] then bound the volume that the steps deliver. Whole pitches deliver an equal volume from
/// every angle.
///
/// A dose may have to end at low flow ([`crate::plan::Finish::LowFlow`]). The plan then takes the allowed end
/// whose volume is nearest, and carries the difference. An end farther from the volume than no dose at all is
/// refused.
///
/// A smooth flow changes the time of each step, but neither the number of steps nor the end angle. A smooth
/// flow is refused if the angle is so uncertain that the flow could be less smooth than at constant speed.
///
/// If a pressure or torque limit is given, the whole dose is predicted from every angle at which the rollers
/// may stand. A dose that breaks a limit is refused, and the error names the nearest dose that holds every
/// limit.
///
/// ```
/// use pump_ctl::plan::{Cruise, Limits, Motor, Phase, Request, plan};
///
/// let pump = pump_model::Pump::three_roller();
/// let motor = Motor { steps_per_rev: 12_800.0, max_speed_rad_s: 17.8, max_acceleration_rad_s2: 500.0 };
/// let request = Request::new(-2.0, Cruise::Fastest);
/// let back = plan(&pump, Phase::known(0.3), &request, &Limits::of_motor(motor))?;
/// assert!((back.planned_ml + 2.0).abs() < 0.001);
/// assert!((back.requested_ml + back.carry_in_ml - back.planned_ml - back.carry_ml).abs() < 1e-12);
/// # Ok::<(), pump_ctl::plan::PlanError>(())
/// ```
///
/// # Errors
///
/// Fails with the [`PlanError`] that says why the dose is refused. The error names the nearest dose that is
/// possible, where there is one.
pub fn plan(pump: &Pump, start: Phase, request: &Request, limits: &Limits) -> Result<Plan, PlanError> {
    limits.validate()?;
    request.validate()?;
    start.validate()?;
    let target = nearest_steps(pump, start, request, limits.motor.step_rad())?;
    Start::at_rest(start).plan(pump, &target, request, limits)
}
