//! A new volume or a new rate in the midst of a dose.

use pump_model::Pump;

use super::start::Start;
use crate::plan::Plan;
use crate::plan::limits::Limits;
use crate::plan::line_states::LineStates;
use crate::plan::target::nearest_steps;
use crate::plan::words::{Allowed, Cruise, Phase, PlanError, Request};

impl Plan {
    /// Plans the rest of this dose anew from the moment at which `made` steps are made.
    ///
    /// `volume_ml` is that of the whole dose, counted from its start. `cruise` is that of the rest, and a
    /// time counts from that moment. A smooth flow stays smooth, and a dose that ends at low flow still does.
    /// The motor's steps per revolution must not change.
    ///
    /// The returned plan has time 0, start angle, volumes and steps of the rest alone. Its `requested_ml` was
    /// still to be delivered, its `before_ml` was delivered before, and its carry is that of the whole dose.
    /// If the start angle is not known exactly, the delivered volume counts by its middle, and the range is
    /// that of the rest.
    ///
    /// The returned plan starts at speed, with the lines as this plan leaves them. Feed its segments after
    /// the [`crate::step::Junction`] at position `made`.
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
    ///
    /// # Errors
    ///
    /// Fails with [`PlanError::CannotStopThere`] if the rotor can no longer stop at the end nearest to the
    /// new volume. Fails with [`PlanError::NoSuchStep`] if the plan ends at `made` or before. It also fails
    /// where [`crate::plan::plan()`] does.
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

    /// Plans the rest of this dose anew as [`Self::retarget`] does, with a choice between smooth flow and
    /// constant speed.
    ///
    /// # Errors
    ///
    /// Fails where [`Self::retarget`] does.
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
                allowed: Allowed::Words("those that it was planned with"),
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
            // No volume is left to deliver, but the rotor turns.
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
            // The states are needed at once, and at every speed that is tried.
            lines = LineStates::Known(lines.states(pump, 0.0));
        }
        let start = Start { phase, speed_rad_s, before_ml: delivered_ml, lines };
        start.plan(pump, &target?, &request, limits)
    }
}
