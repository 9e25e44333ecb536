//! A turn by a number of steps, to a mark, to an index, or by hand.

use pump_model::Pump;

use super::start::Start;
use crate::plan::Plan;
use crate::plan::limits::Limits;
use crate::plan::target::{Target, delivered, middle};
use crate::plan::words::{Cruise, Phase, PlanError, Request};

/// Plans a turn by `steps` (negative in reverse, not zero) at `speed_rad_s`, from rollers at `start`.
///
/// A turn takes and leaves no carry. Its `requested_ml` is the volume that the steps deliver.
///
/// ```
/// # use pump_ctl::plan::{Limits, Motor, Phase, turn};
/// # let motor = Motor { steps_per_rev: 12_800.0, max_speed_rad_s: 17.8, max_acceleration_rad_s2: 500.0 };
/// let pump = pump_model::Pump::three_roller();
/// let anywhere = Phase::unknown(pump.pitch_rad());
/// let revolution = turn(&pump, anywhere, -12_800, 1.0, &Limits::of_motor(motor))?;
/// assert!((revolution.planned_ml + pump.revolution_ml()).abs() < 1e-9);
/// # Ok::<(), pump_ctl::plan::PlanError>(())
/// ```
///
/// # Errors
///
/// Fails with the [`PlanError`] of a value that is out of range, or with that of the limit that the turn
/// breaks.
pub fn turn(
    pump: &Pump,
    start: Phase,
    steps: i64,
    speed_rad_s: f64,
    limits: &Limits,
) -> Result<Plan, PlanError> {
    limits.validate()?;
    start.validate()?;
    let range_ml = delivered(pump, start, steps as f64, limits.motor.step_rad());
    let planned_ml = middle(range_ml);
    let request = Request::new(planned_ml, Cruise::Speed { rad_s: speed_rad_s });
    request.validate()?;
    Start::at_rest(start).plan(pump, &Target { steps, planned_ml, range_ml }, &request, limits)
}
