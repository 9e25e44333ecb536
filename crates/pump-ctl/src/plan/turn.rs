//! A turn by a number of steps: to a mark, to an index, by hand.

use pump_model::Pump;

use super::lines::Lines;
use super::target::{Target, delivered, middle};
use super::{Cruise, Limits, Phase, Plan, PlanError, Request, Start, fastest};

/// Plans a turn by `steps` (negative in reverse, not zero) at `speed_rad_s`, from rollers at `start`. It owes nothing and
/// repays nothing: its `requested_ml` is the volume that the steps deliver.
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
    let rest = Start { phase: start, speed_rad_s: 0.0, before_ml: 0.0, lines: Lines::AT_REST };
    fastest(pump, rest, Target { steps, planned_ml, range_ml }, &request, limits)
}
