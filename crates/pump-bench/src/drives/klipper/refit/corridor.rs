//! The corridor around the times of some steps, and the whole numbers whose steps stay within it.

use super::command::StepCommand;

/// Additions that are tried beside one that fits if intervals could have fractions.
const BESIDE: [i64; 7] = [0, 1, -1, 2, -2, 3, -3];

/// Corridor around the times of the next steps.
#[derive(Debug, Clone, Copy)]
pub(super) struct Corridor<'a> {
    /// Times at which the steps are due, in ticks.
    pub(super) due: &'a [f64],
    /// Time of the step before, as the board makes it, in ticks.
    pub(super) from: f64,
    /// Largest distance of a step from its time, in ticks.
    pub(super) tolerance: f64,
    /// Largest distance of the last step, from which the next command begins.
    pub(super) last_tolerance: f64,
    /// Shortest and longest interval, in ticks.
    pub(super) intervals: (u32, u32),
}

/// Bound of the first interval: a number less `slope` for each tick of addition.
#[derive(Debug, Clone, Copy)]
struct Bound {
    without_add: f64,
    slope: f64,
}

impl Bound {
    fn at(self, add: f64) -> f64 {
        self.without_add - add * self.slope
    }
}

impl Corridor<'_> {
    /// Returns a command whose steps are all within the corridor, or `None` if none was found. The addition is sought
    /// from `guess` on.
    pub(super) fn fit(&self, guess: i16) -> Option<StepCommand> {
        let count = u16::try_from(self.due.len()).ok().filter(|count| *count > 0)?;
        let near = i64::from(if count == 1 { 0 } else { self.add_with_fractions(guess)? });
        BESIDE.iter().find_map(|beside| {
            let add = i16::try_from(near + beside).ok()?;
            let (low, high) = self.bounds(f64::from(add));
            let (low, high) = (low.at(f64::from(add)).ceil(), high.at(f64::from(add)).floor());
            (low <= high).then(|| {
                // Both are whole numbers from 1 to 2^30.
                StepCommand { interval: ((low + high) / 2.0) as u32, count, add }
            })
        })
    }

    /// Returns a whole addition for which an interval, with a fraction, keeps all steps within the corridor.
    ///
    /// For each addition the largest lower bound and the smallest upper bound of the interval decide. Where they
    /// exclude each other, their slopes tell from which addition on these two do not, and all additions before are
    /// left out (the cutting planes of Kelley, 1960).
    fn add_with_fractions(&self, guess: i16) -> Option<i16> {
        let (mut least, mut most) = (f64::from(i16::MIN), f64::from(i16::MAX));
        let mut add = f64::from(guess);
        loop {
            let (low, high) = self.bounds(add);
            if low.at(add) <= high.at(add) {
                return Some(add as i16);
            }
            let slope = low.slope - high.slope;
            let cut = (low.without_add - high.without_add) / slope;
            if slope > 0.0 {
                least = cut.ceil().max(add + 1.0);
                add = least;
            } else if slope < 0.0 {
                most = cut.floor().min(add - 1.0);
                add = most;
            } else {
                return None;
            }
            if least > most {
                return None;
            }
        }
    }

    /// Returns the largest lower bound and the smallest upper bound of the first interval at an addition.
    fn bounds(&self, add: f64) -> (Bound, Bound) {
        let (shortest, longest) = (f64::from(self.intervals.0), f64::from(self.intervals.1));
        let to_last = self.due.len().saturating_sub(1) as f64;
        let [mut low, mut high] = [shortest, longest].map(|without_add| Bound { without_add, slope: 0.0 });
        let (mut lowest, mut highest) = (low.at(add), high.at(add));
        let mut take = |below: Bound, above: Bound| {
            let (least, most) = (below.at(add), above.at(add));
            if least > lowest {
                (low, lowest) = (below, least);
            }
            if most < highest {
                (high, highest) = (above, most);
            }
        };
        take(Bound { without_add: shortest, slope: to_last }, Bound { without_add: longest, slope: to_last });
        let mut left = self.due.len();
        let mut steps = 0.0;
        for due in self.due {
            (steps, left) = (steps + 1.0, left - 1);
            let (after, slope) = (due - self.from, 0.5 * (steps - 1.0));
            let bound = |time: f64| Bound { without_add: time / steps, slope };
            let tolerance = if left == 0 { self.last_tolerance } else { self.tolerance };
            take(bound(after - tolerance), bound(after + tolerance));
        }
        (low, high)
    }
}
