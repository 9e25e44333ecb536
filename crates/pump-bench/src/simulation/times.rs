//! Times at which a waveform is sampled.

use std::ops::Range;

/// Times at equal intervals, n `dt_s`, in s.
#[derive(Debug, Clone)]
pub struct EqualTimes {
    dt_s: f64,
    numbers: Range<u64>,
}

impl EqualTimes {
    /// Makes the times for n = 0 to `intervals`, with `dt_s` in s.
    pub(crate) fn new(dt_s: f64, intervals: u64) -> Self {
        Self { dt_s, numbers: 0..intervals + 1 }
    }
}

impl Iterator for EqualTimes {
    type Item = f64;

    #[inline]
    fn next(&mut self) -> Option<f64> {
        self.numbers.next().map(|n| n as f64 * self.dt_s)
    }
}

/// Returns the times every `dt_s` from 0 to `end_s`, in s. `also_s` stands among them in order, and `end_s`
/// is last.
pub fn times(dt_s: f64, also_s: f64, end_s: f64) -> impl Iterator<Item = f64> {
    let mut also = Some(also_s).filter(|also| *also < end_s);
    let mut n = 0_u64;
    let mut ended = false;
    std::iter::from_fn(move || {
        if ended {
            return None;
        }
        let grid = n as f64 * dt_s;
        if let Some(extra) = also
            && extra <= grid
        {
            also = None;
            if extra < grid {
                return Some(extra);
            }
        }
        n += 1;
        if grid >= end_s {
            ended = true;
            return Some(end_s);
        }
        Some(grid)
    })
}

/// Returns the interval of times that are n intervals from 0 on, n = 0, 1, 2 ..., but for rounding, s. There is none of
/// other times, or of fewer than two.
///
/// ```
/// use pump_bench::simulation::interval_s;
/// assert_eq!(interval_s(&[0.0, 0.1, 0.2, 0.1 + 0.2]), Some((0.1 + 0.2) / 3.0));
/// assert_eq!(interval_s(&[0.0, 0.1, 0.3]), None);
/// ```
pub fn interval_s(times_s: &[f64]) -> Option<f64> {
    let [0.0, .., last_s] = *times_s else { return None };
    let interval_s = last_s / (times_s.len() - 1) as f64;
    // A sum of two rounded numbers is that near.
    let near_s = 2.0 * f64::EPSILON * last_s;
    let is_equal = times_s.iter().enumerate().all(|(n, t)| (t - n as f64 * interval_s).abs() <= near_s);
    (interval_s > 0.0 && is_equal).then_some(interval_s)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_grid_holds_the_last_step_and_both_ends_once() {
        let all = |dt, also, end| times(dt, also, end).collect::<Vec<_>>();
        assert_eq!(all(1.0, 1.5, 2.5), [0.0, 1.0, 1.5, 2.0, 2.5]);
        assert_eq!(all(1.0, 1.0, 2.0), [0.0, 1.0, 2.0]);
        assert_eq!(all(10.0, 1.0, 2.0), [0.0, 1.0, 2.0]);
        assert_eq!(all(1.0, 2.0, 2.0), [0.0, 1.0, 2.0]);
    }
}
