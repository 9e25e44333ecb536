//! A turn by a number of steps, to a mark, to an index, or by hand.

use super::doser::Doser;
use super::start::Start;
use crate::plan::Plan;
use crate::plan::target::{Target, booked, delivered};
use crate::plan::words::{Cruise, Phase, PlanError, Ramps, Request, Turned};

impl Doser<'_> {
    /// Plans a turn by `steps` (negative in reverse, not zero) at `speed_rad_s`, from rollers at `start`.
    ///
    /// A turn starts and stops at the motor's largest acceleration. It takes and leaves no carry. Its
    /// requested volume is the volume that the steps deliver.
    ///
    /// ```
    /// # use pump_ctl::plan::{Doser, Limits, Motor, Phase};
    /// let pump = pump_model::Pump::three_roller();
    /// let doser = Doser::new(&pump, Limits::new(Motor::new(12_800.0, 17.8, 500.0)))?;
    /// let anywhere = Phase::unknown(pump.pitch_rad());
    /// let revolution = doser.turn(anywhere, -12_800, 1.0)?;
    /// assert!((revolution.planned_ml() + pump.revolution_ml()).abs() < 1e-9);
    /// # Ok::<(), pump_ctl::plan::PlanError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Fails with the [`PlanError`] of a value that is out of range, or with that of the limit that the turn
    /// breaks.
    pub fn turn(&self, start: Phase, steps: i64, speed_rad_s: f64) -> Result<Plan, PlanError> {
        let Self { pump, limits } = self;
        start.validate()?;
        let (steps_signed, step_rad) = (steps as f64, limits.motor.step_rad());
        let range_ml = delivered(pump, start, steps_signed, step_rad);
        let planned_ml = booked(pump, Turned::at(start), steps_signed, step_rad);
        let cruise = Cruise::Speed { rad_s: speed_rad_s };
        let request = Request::new(planned_ml, cruise).with_ramps(Ramps::Fastest);
        request.validate()?;
        Start::at_rest(start).plan(pump, &Target { steps, planned_ml, range_ml }, &request, limits)
    }
}
