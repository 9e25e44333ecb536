//! How long a line swings or creeps.

use crate::head::port::Port;
use crate::math::{TURN_RAD, exp, sqrt};

use super::line::Line;
use super::oscillator::{Oscillator, SHORT};

impl Oscillator {
    /// Rate at which its slowest mode dies out, 1/s.
    pub(crate) fn slowest_decay(&self) -> f64 {
        let half = 0.5 * self.decay;
        let square = half * half - self.rate * self.rate;
        // The slow root of the overdamped line, in the form that does not cancel.
        if square <= 0.0 { half } else { self.rate * self.rate / (half + sqrt(square)) }
    }

    /// Length of a step, s, over which the solution is simple: a fraction of the swing; in an overdamped line a
    /// fraction of its fast mode at first, longer as that dies out over the time `since_s` the last edge, and a
    /// sixteenth of the stretch of `length_s` at most; once every mode has died out only the polynomial is left, in 64
    /// parts.
    pub(crate) fn fine_step_s(&self, since_s: f64, length_s: f64) -> f64 {
        let fast_s = SHORT / self.norm();
        if self.slowest_decay() * since_s > 40.0 {
            (length_s / 64.0).max(fast_s)
        } else if self.decay < 2.0 * self.rate.abs() {
            fast_s
        } else {
            (0.3 * since_s).min(length_s / 16.0).max(fast_s)
        }
    }

    /// Time, s, in which a line left alone has reached the largest swings either way that it ever will, from any state:
    /// a whole swing; in an overdamped line, which turns once at most, until every mode has died out.
    pub(crate) fn widest_swing_s(&self) -> f64 {
        let half = 0.5 * self.decay;
        let square = self.rate * self.rate - half * half;
        let died_out_s = 40.0 / self.slowest_decay();
        if square > 0.0 { (TURN_RAD / sqrt(square)).min(died_out_s) } else { died_out_s }
    }

    /// How many steps of [`Self::fine_step_s`] `edges` stretches of together `time_s` take at most.
    pub(crate) fn most_fine_steps(&self, edges: f64, time_s: f64) -> f64 {
        let swinging_s = time_s.min(edges * 40.0 / self.slowest_decay());
        let is_overdamped = self.decay >= 2.0 * self.rate.abs();
        // An overdamped line's steps grow by a third each, to a sixteenth of the stretch.
        let swings = if is_overdamped { 0.0 } else { swinging_s * self.norm() / SHORT };
        swings + 64.0 * edges
    }

    /// Part of a swing that is left after `time_s`; 0 of a line that does not swing.
    pub(crate) fn swing_left(&self, time_s: f64) -> f64 {
        if self.decay < 2.0 * self.rate.abs() { exp(-0.5 * self.decay * time_s) } else { 0.0 }
    }
}

impl Line {
    /// Rate at which the line's slowest mode dies out, 1/s: half of R/L where it swings.
    ///
    /// ```
    /// assert!((pump_model::Line::PUBLISHED.slowest_decay_per_s() - 13.19).abs() < 5e-3);
    /// ```
    pub fn slowest_decay_per_s(&self) -> f64 {
        Oscillator::new(self, Port::Outlet).slowest_decay()
    }
}
