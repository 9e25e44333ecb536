//! The limits of a plan on another pump than the one that it was planned with.

use pump_model::Pump;

use super::start::Start;
use crate::plan::Plan;
use crate::plan::limits::Limits;
use crate::plan::target::Target;
use crate::plan::words::{Cruise, PlanError, Request};

impl Plan {
    /// Refuses this plan, which starts from rest, if its steps break a limit on `pump`.
    ///
    /// Use it where the steps follow from one model, and the true displacement is that of another. Such a
    /// plan is a run to be weighed: the model gives its steps, and a calibration its pressures.
    ///
    /// ```
    /// use pump_ctl::plan::{Doser, Limits, Motor, Phase, PressureLimits};
    ///
    /// let pump = pump_model::Pump::three_roller();
    /// let pressures = PressureLimits { max_outlet_kpa: Some(110.0), ..PressureLimits::NONE };
    /// let limits = Limits::new(Motor::new(12_800.0, 17.8, 500.0)).with_pressures(pressures);
    /// let plan = Doser::new(&pump, limits)?.turn(Phase::known(0.0), 12_800, 10.0)?;
    /// assert!(plan.check_on(&pump, &limits).is_ok());
    /// assert!(plan.check_on(&pump.scaled(1.3)?, &limits).is_err());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Fails with the [`PlanError`] of the limit that is broken. It names the nearest speed that holds every
    /// limit.
    pub fn check_on(&self, pump: &Pump, limits: &Limits) -> Result<(), PlanError> {
        let cruise = Cruise::Speed { rad_s: self.profile.cruise_rad_s() };
        let (target, request) = self.asked_again(cruise, limits)?;
        let shape = self.profile.course.shape;
        Start::at_rest(self.start).plan_with_shape(pump, &target, &request, limits, shape).map(drop)
    }

    /// Returns this plan, which starts from rest, at the fastest cruise that holds the limits on `pump`. The steps and
    /// their volumes stay.
    ///
    /// ```
    /// use pump_ctl::plan::{Doser, LimitedBy, Limits, Motor, Phase, PressureLimits};
    ///
    /// let pump = pump_model::Pump::three_roller();
    /// let pressures = PressureLimits { max_outlet_kpa: Some(110.0), ..PressureLimits::NONE };
    /// let limits = Limits::new(Motor::new(12_800.0, 17.8, 500.0)).with_pressures(pressures);
    /// let plan = Doser::new(&pump, limits)?.turn(Phase::known(0.0), 12_800, 10.0)?;
    /// let slower = plan.fastest_on(&pump.scaled(1.3)?, &limits)?;
    /// assert!(slower.profile().cruise_rad_s() < 10.0 && slower.steps() == plan.steps());
    /// assert_eq!(slower.limited_by(), LimitedBy::OutletPressure);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Fails with the [`PlanError`] of a limit that no cruise holds.
    pub fn fastest_on(&self, pump: &Pump, limits: &Limits) -> Result<Self, PlanError> {
        let (target, request) = self.asked_again(Cruise::Fastest, limits)?;
        let fastest = Start::at_rest(self.start).plan(pump, &target, &request, limits)?;
        let Self { profile, limited_by, .. } = fastest;
        Ok(Self { profile, limited_by, ..self.clone() })
    }

    /// Returns the steps of this plan as a target, and a request for them at another speed.
    fn asked_again(&self, cruise: Cruise, limits: &Limits) -> Result<(Target, Request), PlanError> {
        limits.validate()?;
        let range_ml = (self.least_ml, self.most_ml);
        let target = Target { steps: self.steps, planned_ml: self.planned_ml, range_ml };
        let request = Request::new(self.requested_ml, cruise).with_ramps(self.ramps);
        Ok((target, request.with_smooth(self.is_smooth())))
    }
}
