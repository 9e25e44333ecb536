//! The volume that a dose in motion can still end at, on a head whose flow reverses.

use pump_model::Pump;

use crate::plan::target::nearest_steps;
use crate::plan::words::{Phase, Request};

/// Volumes that are tried, each a part of a pitch farther.
const TRIES: u32 = 64;

/// Part of a pitch's volume between two volumes that are tried.
const PART: f64 = 1.0 / 16.0;

/// Returns the first volume from `least_ml` on whose dose takes `stopping` steps at least, mL from `start`. Both
/// volumes are negative in reverse.
///
/// Where the flow reverses, the volume at which the rotor can stop may have been reached before. A dose of it would
/// end there.
#[cold]
#[inline(never)]
pub(super) fn offered_ml(
    pump: &Pump,
    start: Phase,
    request: &Request,
    (least_ml, stopping): (f64, i64),
    direction: i64,
    step_rad: f64,
) -> f64 {
    let part_ml = direction as f64 * PART * pump.outlet_curve().pitch_ml();
    let volumes = (0..TRIES).map(|number| least_ml + f64::from(number) * part_ml);
    let is_far_enough = |volume_ml: &f64| {
        let request = Request { volume_ml: *volume_ml, ..*request };
        let target = nearest_steps(pump, start, &request, step_rad);
        target.is_ok_and(|target| target.steps.saturating_mul(direction) >= stopping)
    };
    volumes.into_iter().find(is_far_enough).unwrap_or(least_ml)
}
