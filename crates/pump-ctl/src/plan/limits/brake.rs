//! The brake of a motor, by which the executor stops.

use libm::{ceil, floor, pow, sqrt};

use super::motor::Motor;
use crate::step::{BRAKE_ENTRIES, Brake, BrakeError, Segment, TickRate};

/// Number of entries of one step each, from rest.
const SINGLE: usize = 6;

impl Motor {
    /// Returns the way to rest from any speed up to this motor's largest, for a timer of this
    /// rate.
    ///
    /// The brake nowhere decelerates more than the motor may. Intervals grow evenly inside an entry, so it
    /// decelerates less in most places. It takes up to twice the angle of a stop at the limit. For the
    /// built-in pumps the angle is 1.17 to 1.24 times as large (measured).
    ///
    /// # Errors
    ///
    /// Fails with [`BrakeError::OutOfRange`] if a value of the motor is out of its range, and with
    /// [`BrakeError::SlowTimer`] if the motor's first step takes less than a tick.
    pub fn brake(&self, tick_rate: TickRate) -> Result<Brake, BrakeError> {
        self.in_range().map_err(|(parameter, value, allowed)| BrakeError::OutOfRange {
            parameter,
            value,
            allowed,
        })?;
        // Twice the steps of a stop at the limit are enough for the weakest deceleration below.
        let stop = self.max_speed_rad_s * self.max_speed_rad_s / (2.0 * self.max_acceleration_rad_s2);
        let steps = ceil(2.0 * stop / self.step_rad()).clamp(BRAKE_ENTRIES as f64, 1e9);
        let geometric = (BRAKE_ENTRIES - SINGLE) as f64;
        let ratio = pow(steps / SINGLE as f64, 1.0 / geometric);
        let acceleration_rad_s2 = self.max_acceleration_rad_s2 / steepest(ratio);

        let time = |n: f64| f64::from(tick_rate.hz()) * sqrt(2.0 * n * self.step_rad() / acceleration_rad_s2);
        let interval = |n: f64| time(n + 1.0) - time(n);
        let mut start = 0.0;
        Brake::climbing(tick_rate, |entry| {
            let end = if entry < SINGLE {
                start + 1.0
            } else {
                let power = (entry + 1 - SINGLE) as f64;
                floor(SINGLE as f64 * pow(ratio, power) + 0.5).max(start + 1.0)
            };
            let count = end - start;
            let add = if count > 1.0 { (interval(end) - interval(start)) / count } else { 0.0 };
            let fixed = (interval(start) * FRACTIONS) as i128;
            start = end;
            Segment {
                count: count as i32,
                interval: (fixed >> 32) as u64,
                frac: fixed as u32,
                add: (add * FRACTIONS) as i64,
            }
        })
    }
}

/// Fractions of the executor in a tick, 2^32.
const FRACTIONS: f64 = 4_294_967_296.0;

/// Returns the largest deceleration over an even one, where the interval I grows evenly from step `ratio` n
/// down to step n.
///
/// At even deceleration a the speed is sqrt(2 a n) and I = 1 / sqrt(2 a n). With I straight between the two
/// ends the deceleration is -I' / I³, largest at the fast end: 2 a (1 - ratio^-1/2) ratio^3/2 / (ratio - 1).
fn steepest(ratio: f64) -> f64 {
    let root = sqrt(ratio);
    2.0 * (1.0 - 1.0 / root) * ratio * root / (ratio - 1.0)
}
