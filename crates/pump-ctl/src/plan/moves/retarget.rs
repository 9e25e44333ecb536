//! A new volume or a new rate in the midst of a dose.

use super::doser::Doser;
use super::offer::offered_ml;
use super::start::Start;
use crate::parameter::Parameter;
use crate::plan::Plan;
use crate::plan::line_states::LineStates;
use crate::plan::target::nearest_steps;
use crate::plan::words::{Allowed, Cruise, PlanError, Request, Retarget};

impl Doser<'_> {
    /// Plans the rest of a dose anew from the moment at which the change takes over.
    ///
    /// A smooth flow stays smooth unless the change says otherwise, and a dose that ends at low flow still
    /// does. The motor's steps per revolution must not change.
    ///
    /// The returned plan has time 0, start angle, volumes and steps of the rest alone. Its requested volume was
    /// still to be delivered, its [`Plan::before_ml`] was delivered before, and its carry is that of the whole
    /// dose. If the start angle is not stated ([`crate::plan::Phase::is_stated`]), the delivered volume counts by its
    /// middle. The range is that of the rest.
    ///
    /// The returned plan starts at speed, with the lines as the old plan leaves them. Feed its segments after
    /// the [`crate::step::Junction`] at the position of the change.
    ///
    /// ```
    /// # use pump_ctl::plan::{Cruise, Doser, Limits, Motor, Phase, Request, Retarget};
    /// let pump = pump_model::Pump::three_roller();
    /// let doser = Doser::new(&pump, Limits::new(Motor::new(12_800.0, 17.8, 500.0)))?;
    /// let whole = doser.plan(Phase::known(0.3), &Request::new(25.0, Cruise::Flow { ml_s: 5.0 }))?;
    /// let rest = doser.retarget(&whole, &Retarget::new(6000, 30.0, Cruise::Flow { ml_s: 10.0 }))?;
    /// let delivered_ml = whole.delivered_ml(&pump, 6000) + rest.planned_ml();
    /// assert!((delivered_ml - 30.0).abs() < 0.001);
    /// # Ok::<(), pump_ctl::plan::PlanError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Fails with [`PlanError::CannotStopThere`] if the rotor can no longer stop at the end nearest to the
    /// new volume. Fails with [`PlanError::NoSuchStep`] if the plan ends at the change or before. It also fails
    /// where [`Self::plan`] does.
    pub fn retarget(&self, plan: &Plan, change: &Retarget) -> Result<Plan, PlanError> {
        let Self { pump, limits } = self;
        let Retarget { made, volume_ml, cruise, smooth } = *change;
        let smooth = smooth.unwrap_or(plan.is_smooth());
        let steps = plan.steps.unsigned_abs();
        if made >= steps {
            return Err(PlanError::NoSuchStep { made, steps });
        }
        let carry_in_ml = plan.carry_in_ml;
        let (finish, ramps) = (plan.finish, plan.ramps);
        let turned = Some(plan.turned_after(made)).filter(|turned| !turned.is_exact());
        Request { volume_ml, carry_in_ml, cruise, smooth, finish, turned, ramps }.validate()?;
        if limits.motor.step_rad() != plan.step_rad {
            return Err(PlanError::OutOfRange {
                parameter: Parameter::StepsPerRevUnderWay,
                value: limits.motor.steps_per_rev,
                allowed: Allowed::Words("those that it was planned with"),
            });
        }
        let delivered_ml = plan.before_ml + plan.delivered_ml(pump, made);
        let volume_left_ml = volume_ml - delivered_ml;
        let request =
            Request { volume_ml: volume_left_ml, carry_in_ml, cruise, smooth, finish, turned, ramps };

        let phase = plan.start.moved_to(plan.angle_after(made));
        let speed_rad_s = plan.speed_after(made);
        let target = nearest_steps(pump, phase, &request, plan.step_rad);
        let stopping = plan.stopping_steps(made, limits.motor.max_acceleration_rad_s2).max(1);
        let too_few = match &target {
            Ok(target) => target.steps * i64::from(plan.direction().sign()) < stopping,
            // No volume is left to deliver, but the rotor turns.
            Err(PlanError::LessThanHalfAStep { .. }) => true,
            Err(_) => false,
        };
        if too_few {
            let stands = made.saturating_add_signed(stopping);
            let mut nearest_ml = plan.before_ml + plan.delivered_ml(pump, stands);
            if pump.outlet_curve().reverses() {
                let (direction, least_ml) = (plan.direction().sign().into(), nearest_ml - delivered_ml);
                let (least, step_rad) = ((least_ml, stopping), plan.step_rad);
                nearest_ml = delivered_ml + offered_ml(pump, phase, &request, least, direction, step_rad);
            }
            return Err(PlanError::CannotStopThere { asked_ml: volume_ml, delivered_ml, nearest_ml });
        }
        let mut lines = plan.lines_at(pump, made);
        let needed = limits.are_predicted() || matches!(cruise, Cruise::Within { .. } | Cruise::Fastest);
        if needed && phase.half_width_rad == 0.0 {
            // The states are needed at once, and at every speed that is tried.
            lines = LineStates::Known(lines.states(pump, 0.0));
        }
        let start = Start { phase, speed_rad_s, before_ml: delivered_ml, lines };
        start.plan(pump, &target?, &request, limits)
    }
}
