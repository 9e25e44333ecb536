//! A speed that is a function of time, as legs of constant acceleration.

use pump_model::Leg;
use pyo3::prelude::*;

use crate::python::append;
use crate::python::errors::value;

/// Largest distance of a leg's speed from the function, as a part of 1 rad/s and the speed.
const NEAR: f64 = 1e-6;
/// Most times that an interval is cut in two. A jump of the speed is placed as well as that.
const DEEPEST: u32 = 30;
/// Most legs.
const MOST_LEGS: usize = 1_000_000;

/// Returns the legs that follow `speed` (s to rad/s) from time 0 to `end_s`. At first it is looked at in `looks`
/// intervals, which are cut in two until a straight line follows the speed.
///
/// Each line goes through the speeds at the two nodes of Gauss's rule. So the angle of a leg is exact to the fourth
/// order of its duration, and what the lines miss of the speed has no mean.
pub(super) fn followed(
    name: &str,
    speed: impl Fn(f64) -> PyResult<f64>,
    end_s: f64,
    looks: u64,
    start_rad: f64,
) -> PyResult<Vec<Leg>> {
    let mut legs = Vec::new();
    let mut angle_rad = start_rad;
    let mut start_s = 0.0;
    let edge_s = |n: u64| end_s * (n as f64 / looks as f64);
    for look in 0..looks {
        // Intervals to come, the next one last.
        let mut later = vec![(edge_s(look), edge_s(look + 1), 0)];
        while let Some((from_s, to_s, depth)) = later.pop() {
            let middle_s = 0.5 * (from_s + to_s);
            let line = Line::of(&speed, from_s, to_s)?;
            if !line.follows && depth < DEEPEST && from_s < middle_s && middle_s < to_s {
                later.push((middle_s, to_s, depth + 1));
                later.push((from_s, middle_s, depth + 1));
                continue;
            }
            if legs.len() == MOST_LEGS {
                return Err(value(format_args!(
                    "{name} changes too often up to {from_s} s to be followed in {MOST_LEGS} pieces; allowed: a \
                     smooth function with a few jumps, or an array of speeds at the times time_s"
                )));
            }
            // A jump that is not cut any more has no slope.
            let slope = if line.follows { line.slope } else { 0.0 };
            let duration_s = to_s - start_s;
            let speed_rad_s = line.mean_rad_s - 0.5 * slope * duration_s;
            let leg = Leg { start_s, duration_s, angle_rad, speed_rad_s, acceleration_rad_s2: slope };
            if duration_s > 0.0 {
                (start_s, angle_rad) = (leg.end_s(), leg.end_angle_rad());
                append(&mut legs, leg)?;
            }
        }
    }
    let last_rad_s = speed(end_s)?;
    append(&mut legs, Leg { start_s, ..Leg::constant_speed(angle_rad, last_rad_s) })?;
    Ok(legs)
}

/// A straight line through a speed.
struct Line {
    mean_rad_s: f64,
    slope: f64,
    /// True if the line is near the speed at the ends and in the middle.
    follows: bool,
}

impl Line {
    fn of(speed: &impl Fn(f64) -> PyResult<f64>, from_s: f64, to_s: f64) -> PyResult<Self> {
        let (middle_s, half_s) = (0.5 * (from_s + to_s), 0.5 * (to_s - from_s));
        if half_s == 0.0 {
            return Ok(Self { mean_rad_s: speed(from_s)?, slope: 0.0, follows: true });
        }
        let node_s = half_s / 3.0_f64.sqrt();
        let (before, after) = (speed(middle_s - node_s)?, speed(middle_s + node_s)?);
        let (mean_rad_s, slope) = (0.5 * (before + after), 0.5 * (after - before) / node_s);
        let mut follows = true;
        for place_s in [-half_s, 0.0, half_s] {
            let there = speed(middle_s + place_s)?;
            follows &= (mean_rad_s + slope * place_s - there).abs() <= NEAR * (1.0 + there.abs());
        }
        Ok(Self { mean_rad_s, slope, follows })
    }
}
