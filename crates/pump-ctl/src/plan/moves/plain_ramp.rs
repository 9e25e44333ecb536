//! The acceleration of a board that has one for every dose.

use super::doser::Doser;
use crate::plan::limits::Limits;
use crate::plan::ramps::best_plain;
use crate::plan::speed::speed_for_flow;
use crate::plan::words::{Cruise, Phase, PlanError, Ramps, Request};

impl Doser<'_> {
    /// Returns the best acceleration for a board that starts and stops every dose in one plain ramp, rad/s², for
    /// doses at this rate. It is within the motor's limit.
    ///
    /// The choice is that of [`Ramps::LineAware`], restricted to one leg up and one down, which are alike. It
    /// takes the worst back flow and the mean time of doses of a pitch from twelve start angles.
    ///
    /// ```
    /// use pump_ctl::plan::{Doser, Limits, Motor};
    ///
    /// let pump = pump_model::Pump::three_roller();
    /// let doser = Doser::new(&pump, Limits::new(Motor::new(12_800.0, 17.8, 500.0)))?;
    /// let acceleration_rad_s2 = doser.plain_acceleration_rad_s2(5.0)?;
    /// assert!(acceleration_rad_s2 > 5.0 && acceleration_rad_s2 < 40.0);
    /// # Ok::<(), pump_ctl::plan::PlanError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Fails with the [`PlanError`] of a rate that is out of range, or too fast for the motor.
    pub fn plain_acceleration_rad_s2(&self, ml_s: f64) -> Result<f64, PlanError> {
        let Self { pump, limits } = self;
        let rad_s = speed_for_flow(pump, ml_s);
        best_plain(pump, limits.motor.max_acceleration_rad_s2, |start_rad, acceleration_rad_s2| {
            let motor = limits.motor.with_max_acceleration_rad_s2(acceleration_rad_s2);
            let request = Request::new(pump.outlet_curve().pitch_ml(), Cruise::Speed { rad_s });
            let doser = Doser { pump, limits: Limits::new(motor) };
            doser.plan(Phase::known(start_rad), &request.with_ramps(Ramps::Fastest))
        })
    }
}
