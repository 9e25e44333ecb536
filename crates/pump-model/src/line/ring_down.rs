//! The way of a line to rest in closed form.

use core::f64::consts::PI;

use libm::{acos, atan2, cos, exp, log, sin, sqrt};

use super::line::Line;
use super::line_state::LineState;
use super::settling::SETTLED_ML;

/// Largest number of turns that are followed. A line that swings on is not about to rest.
const MOST_TURNS: u32 = 256;

/// The volume that an outlet line holds too much while it comes to rest, C p, as it swings or creeps to 0.
///
/// Left alone, the line follows p'' + 2 s p' + w² p = 0 with s = R/(2 L), w² = 1/(L C) and p' = -Q/C at first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RingDown {
    /// Volume at first, mL, and its rate of change, mL/s.
    first_ml: f64,
    rate_ml_s: f64,
    /// Decay rate s, 1/s.
    decay: f64,
    /// w² - s², 1/s². It is negative for a line that creeps.
    square: f64,
    /// w², 1/s².
    natural_square: f64,
}

impl RingDown {
    /// Makes the way to rest of an outlet `line` from `state`, with the rotor at rest.
    pub fn new(line: &Line, state: LineState) -> Self {
        let decay = 0.5 * line.resistance_kpa_s_ml / line.inertance_kpa_s2_ml;
        let natural_square = 1.0 / (line.inertance_kpa_s2_ml * line.compliance_ml_kpa);
        // A line damped critically counts as one that swings by a hair.
        let square = natural_square - decay * decay;
        let square = if square.abs() < 1e-9 * natural_square { 1e-9 * natural_square } else { square };
        Self {
            first_ml: line.compliance_ml_kpa * state.above_reservoir_kpa,
            rate_ml_s: -state.flow_ml_s,
            decay,
            square,
            natural_square,
        }
    }

    /// Returns the time at which the volume turns first, s, and the volume there, mL. `None` if the line creeps
    /// to rest without a turn.
    fn turn(&self) -> Option<(f64, f64)> {
        let Self { first_ml, rate_ml_s, decay, square, natural_square } = *self;
        if square > 0.0 {
            let swing = sqrt(square);
            let push = natural_square * first_ml + decay * rate_ml_s;
            let angle = atan2(rate_ml_s * swing, push);
            let angle = if angle > 0.0 { angle } else { angle + PI };
            let time_s = angle / swing;
            let beside_ml = (rate_ml_s + decay * first_ml) / swing;
            Some((time_s, exp(-decay * time_s) * (first_ml * cos(angle) + beside_ml * sin(angle))))
        } else {
            let [(slow, slow_ml), (fast, fast_ml)] = self.modes();
            let ratio = -fast_ml * fast / (slow_ml * slow);
            (ratio > 1.0 && ratio.is_finite()).then(|| {
                let time_s = log(ratio) / (fast - slow);
                (time_s, slow_ml * exp(-slow * time_s) + fast_ml * exp(-fast * time_s))
            })
        }
    }

    /// Returns the slow and the fast mode of a line that creeps: rates, 1/s, and volumes at first, mL.
    fn modes(&self) -> [(f64, f64); 2] {
        let spread = sqrt(-self.square);
        let fast = self.decay + spread;
        let slow = self.natural_square / fast;
        let gap = fast - slow;
        let slow_ml = (self.rate_ml_s + fast * self.first_ml) / gap;
        [(slow, slow_ml), (fast, self.first_ml - slow_ml)]
    }

    /// Returns the part of a swing that is left half a swing later, and the time of half a swing, s.
    fn half_swing(&self) -> (f64, f64) {
        let half_s = PI / sqrt(self.square);
        (exp(-self.decay * half_s), half_s)
    }

    /// Returns the largest volume below zero that the line comes to hold, mL, not negative. The line takes it
    /// back from the vessel. `direction` is 1 for a dose forward and -1 for one in reverse, which counts
    /// mirrored.
    ///
    /// ```
    /// use pump_model::{Line, LineState, RingDown};
    ///
    /// // Flow runs on in the line when the rotor has stopped.
    /// let state = LineState { above_reservoir_kpa: 0.5, flow_ml_s: 5.0 };
    /// let taken_ml = RingDown::new(&Line::PUBLISHED, state).taken_back_ml(1.0);
    /// assert!(taken_ml > 0.03 && taken_ml < 0.05);
    /// ```
    pub fn taken_back_ml(&self, direction: f64) -> f64 {
        let first_ml = (-direction * self.first_ml).max(0.0);
        let Some((_, turn_ml)) = self.turn() else { return first_ml };
        let later_ml = if self.square > 0.0 { -turn_ml * self.half_swing().0 } else { 0.0 };
        first_ml.max(-direction * turn_ml).max(-direction * later_ml)
    }

    /// Returns about the time after which the volume stays below [`SETTLED_ML`] either way, s. Between two
    /// turns the volume counts as a cosine.
    pub fn settled_after_s(&self) -> f64 {
        let below = |ml: f64| ml.abs() <= SETTLED_ML;
        if self.square <= 0.0 {
            let [slow, fast] = self.modes().map(|(rate, ml)| log(ml.abs() / SETTLED_ML).max(0.0) / rate);
            return slow.max(fast);
        }
        let Some((time_s, turn_ml)) = self.turn() else { return 0.0 };
        let (left, half_s) = self.half_swing();
        if below(turn_ml) {
            // It falls below the limit before the turn, or is there already.
            let first_ml = self.first_ml.abs();
            let fallen = (first_ml - SETTLED_ML) / (first_ml + turn_ml.abs());
            return if below(self.first_ml) { 0.0 } else { time_s * fallen.min(1.0) };
        }
        // The last turn beyond the limit, and the way from there to the limit.
        let mut last_s = time_s;
        let mut last_ml = turn_ml.abs();
        for _ in 0..MOST_TURNS {
            if last_ml * left <= SETTLED_ML {
                break;
            }
            last_ml *= left;
            last_s += half_s;
        }
        last_s + acos(SETTLED_ML / last_ml) * half_s / PI
    }
}
