//! The planner of doses, and the plan of a dose from rest.

use pump_model::Pump;

use super::start::Start;
use crate::plan::Plan;
use crate::plan::limits::Limits;
use crate::plan::target::nearest_steps;
use crate::plan::words::{Phase, PlanError, Request};

/// A pump and the limits of its doses. It plans doses, turns and changes in mid-dose.
///
/// ```
/// use pump_ctl::plan::{Cruise, Doser, Limits, Motor, Phase, Request, Retarget};
///
/// let pump = pump_model::Pump::three_roller();
/// let doser = Doser::new(&pump, Limits::new(Motor::new(12_800.0, 17.8, 500.0)))?;
/// let dose = doser.plan(Phase::known(0.3), &Request::new(25.0, Cruise::Flow { ml_s: 5.0 }))?;
/// assert_eq!(dose.steps(), 15_287);
/// // After 6000 steps the dose is to be 30 mL, and twice as fast.
/// let rest = doser.retarget(&dose, &Retarget::new(6000, 30.0, Cruise::Flow { ml_s: 10.0 }))?;
/// assert!((dose.delivered_ml(&pump, 6000) + rest.planned_ml() - 30.0).abs() < 0.001);
/// // A revolution has one volume from every angle.
/// let turn = doser.turn(Phase::known(0.3), 12_800, 1.0)?;
/// assert!((turn.planned_ml() - pump.revolution_ml()).abs() < 1e-9);
/// # Ok::<(), pump_ctl::plan::PlanError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Doser<'a> {
    pub(super) pump: &'a Pump,
    pub(super) limits: Limits,
}

impl<'a> Doser<'a> {
    /// Makes a planner of doses of a pump within limits.
    ///
    /// # Errors
    ///
    /// Fails with [`PlanError::OutOfRange`], which names the limit, its value and the allowed range.
    pub fn new(pump: &'a Pump, limits: Limits) -> Result<Self, PlanError> {
        limits.validate()?;
        Ok(Self { pump, limits })
    }

    /// Returns the pump.
    pub fn pump(&self) -> &'a Pump {
        self.pump
    }

    /// Returns the limits.
    pub fn limits(&self) -> &Limits {
        &self.limits
    }

    /// Plans a dose. Its steps are those whose volume is nearest to the volume requested plus carried.
    ///
    /// The profile is the fastest that the request and the limits allow. Steps and end angle do not depend on
    /// the speed.
    ///
    /// The angle solves V_out(theta_1) = V_out(theta_0) + V for the outlet's exact volume curve, so the dose
    /// is right from any start angle. An angle that is known to less than 2 deg counts as stated
    /// ([`Phase::is_stated`]), and the steps are those from that very angle. From an angle that is known less well
    /// the steps minimise the worst deviation over all angles at which the rollers may stand (minimax).
    /// [`Plan::least_ml`] and [`Plan::most_ml`] bound the volume that the steps deliver. Whole pitches deliver an
    /// equal volume from every angle.
    ///
    /// A dose may have to end at low flow ([`crate::plan::Finish::LowFlow`]). The plan then takes the allowed
    /// end whose volume is nearest, and carries the difference. An end farther from the volume than no dose at
    /// all is refused.
    ///
    /// A smooth flow changes the time of each step, but neither the number of steps nor the end angle. A
    /// smooth flow is refused if the angle is so uncertain that the flow could be less smooth than at constant
    /// speed.
    ///
    /// If a pressure or torque limit is given, the whole dose is predicted from every angle at which the
    /// rollers may stand. A dose that breaks a limit is refused, and the error names the nearest dose that
    /// holds every limit.
    ///
    /// ```
    /// use pump_ctl::plan::{Cruise, Doser, Limits, Motor, Phase, Request};
    ///
    /// let pump = pump_model::Pump::three_roller();
    /// let doser = Doser::new(&pump, Limits::new(Motor::new(12_800.0, 17.8, 500.0)))?;
    /// let back = doser.plan(Phase::known(0.3), &Request::new(-2.0, Cruise::Fastest))?;
    /// assert!((back.planned_ml() + 2.0).abs() < 0.001);
    /// assert!((back.requested_ml() + back.carry_in_ml() - back.planned_ml() - back.carry_ml()).abs() < 1e-12);
    /// # Ok::<(), pump_ctl::plan::PlanError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Fails with the [`PlanError`] that says why the dose is refused. The error names the nearest dose that
    /// is possible, where there is one.
    pub fn plan(&self, start: Phase, request: &Request) -> Result<Plan, PlanError> {
        let Self { pump, limits } = self;
        request.validate()?;
        start.validate()?;
        let target = nearest_steps(pump, start, request, limits.motor.step_rad())?;
        Start::at_rest(start).plan(pump, &target, request, limits)
    }
}
