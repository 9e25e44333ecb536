//! The best plain ramp: one acceleration for every dose, up and down.

use libm::pow;
use pump_model::Pump;

use super::left_over::Outcome;
use super::search::outcome_from_rest;
use crate::plan::Plan;

/// Start angles over a pitch from which an acceleration is tried.
const ANGLES: u32 = 12;

/// Accelerations that are tried, each a part of the one before.
const TRIES: u32 = 48;

/// Part of the acceleration before. 48 tries reach 1/70 of the largest.
const PART: f64 = 0.915;

/// Finds the acceleration, rad/s², up to `largest_rad_s2`, whose doses are best from the worst start angle.
///
/// `dose_of` makes the dose that starts at an angle and has an acceleration. The back flow of an acceleration is the
/// largest of its doses, its time the mean.
pub(in crate::plan) fn best_plain<E>(
    pump: &Pump,
    largest_rad_s2: f64,
    dose_of: impl Fn(f64, f64) -> Result<Plan, E>,
) -> Result<f64, E> {
    let mut best: Option<(f64, Outcome)> = None;
    for number in 0..TRIES {
        let acceleration_rad_s2 = largest_rad_s2 * pow(PART, f64::from(number));
        let mut all = Outcome { taken_back_ml: 0.0, time_s: 0.0, limit_ml: 0.0 };
        for angle in 0..ANGLES {
            let start_rad = pump.pitch_rad() * f64::from(angle) / f64::from(ANGLES);
            let one = outcome_from_rest(pump, &dose_of(start_rad, acceleration_rad_s2)?);
            all.taken_back_ml = all.taken_back_ml.max(one.taken_back_ml);
            all.limit_ml = one.limit_ml;
            all.time_s += one.time_s / f64::from(ANGLES);
        }
        if best.is_none_or(|(_, best)| all.is_better_than(&best)) {
            best = Some((acceleration_rad_s2, all));
        }
    }
    Ok(best.map_or(largest_rad_s2, |(acceleration_rad_s2, _)| acceleration_rad_s2))
}
