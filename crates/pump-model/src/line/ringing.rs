//! Times over which a line swings or creeps.

use libm::{exp, sqrt};

use crate::port::Port;
use crate::units::TURN_RAD;

use super::line::Line;
use super::oscillator::{Oscillator, SHORT};

impl Oscillator {
    /// Returns the rate at which the slowest mode dies out, 1/s.
    pub(crate) fn slowest_decay(&self) -> f64 {
        let half = 0.5 * self.decay;
        let square = half * half - self.rate * self.rate;
        // The slow root of the overdamped line, in the form that does not cancel.
        if square <= 0.0 { half } else { self.rate * self.rate / (half + sqrt(square)) }
    }

    /// Returns true if the line swings.
    pub(crate) fn swings(&self) -> bool {
        self.decay < 2.0 * self.rate.abs()
    }

    /// Returns the length of a step over which the solution is simple, s.
    ///
    /// For a line that swings it is a fraction of the swing. For an overdamped line it starts as a fraction
    /// of the fast mode. It grows as that mode dies out over the time `since_s` the last edge, to a sixteenth
    /// of the stretch of `length_s` at most. Once every mode has died out only the polynomial is left, in 64
    /// parts.
    pub(crate) fn fine_step_s(&self, since_s: f64, length_s: f64) -> f64 {
        let fast_s = SHORT / self.norm();
        if self.slowest_decay() * since_s > 40.0 {
            (length_s / 64.0).max(fast_s)
        } else if self.swings() {
            fast_s
        } else {
            (0.3 * since_s).min(length_s / 16.0).max(fast_s)
        }
    }

    /// Returns the time in which a line left alone reaches its largest swings either way, from any state, s.
    ///
    /// It is a whole swing. In an overdamped line, which turns once at most, it is the time until every mode
    /// has died out.
    pub(crate) fn widest_swing_s(&self) -> f64 {
        let half = 0.5 * self.decay;
        let square = self.rate * self.rate - half * half;
        let died_out_s = 40.0 / self.slowest_decay();
        if square > 0.0 { (TURN_RAD / sqrt(square)).min(died_out_s) } else { died_out_s }
    }

    /// Returns the largest number of steps of [`Self::fine_step_s`] over `edges` stretches of together
    /// `time_s`.
    pub(crate) fn most_fine_steps(&self, edges: f64, time_s: f64) -> f64 {
        let swinging_s = time_s.min(edges * 40.0 / self.slowest_decay());
        // An overdamped line's steps grow by a third each, to a sixteenth of the stretch.
        let swings = if self.swings() { swinging_s * self.norm() / SHORT } else { 0.0 };
        swings + 64.0 * edges
    }

    /// Returns the part of a swing that is left after `time_s`; 0 for a line that does not swing.
    pub(crate) fn swing_left(&self, time_s: f64) -> f64 {
        if self.swings() { exp(-0.5 * self.decay * time_s) } else { 0.0 }
    }
}

impl Line {
    /// Returns the rate at which the line's slowest mode dies out, 1/s. It is half of R/L where the line
    /// swings.
    ///
    /// ```
    /// assert!((pump_model::Line::PUBLISHED.slowest_decay_per_s() - 13.19).abs() < 5e-3);
    /// ```
    pub fn slowest_decay_per_s(&self) -> f64 {
        Oscillator::new(self, Port::Outlet).slowest_decay()
    }
}
