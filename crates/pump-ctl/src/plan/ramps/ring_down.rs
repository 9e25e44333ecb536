//! The way of a line to rest in closed form.

use core::f64::consts::PI;

use libm::{acos, atan2, cos, exp, log, sin, sqrt};

use pump_model::{Line, LineState, SETTLED_ML};

/// Largest number of turns that are followed. A line that swings on is not about to rest.
const MOST_TURNS: u32 = 256;

/// The constants of a line that comes to rest, computed once for all ways to rest.
///
/// Left alone, the line follows p'' + 2 s p' + w² p = 0 with s = R/(2 L), w² = 1/(L C) and p' = -Q/C at first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Decay {
    compliance_ml_kpa: f64,
    /// Decay rate s, 1/s.
    decay: f64,
    /// w² - s², 1/s². It is negative for a line that creeps.
    square: f64,
    /// w², 1/s².
    natural_square: f64,
    /// Root of w² - s², or of s² - w² for a line that creeps, 1/s.
    root: f64,
    /// Part of a swing that is left half a swing later, and the time of half a swing, s. A line that creeps has none.
    half_swing: (f64, f64),
}

impl Decay {
    /// Computes the constants of an outlet `line`, with the rotor at rest.
    pub(super) fn new(line: &Line) -> Self {
        let decay = 0.5 * line.resistance_kpa_s_ml / line.inertance_kpa_s2_ml;
        let natural_square = 1.0 / (line.inertance_kpa_s2_ml * line.compliance_ml_kpa);
        // A line damped critically counts as one that swings by a hair.
        let square = natural_square - decay * decay;
        let square = if square.abs() < 1e-9 * natural_square { 1e-9 * natural_square } else { square };
        let root = sqrt(square.abs());
        let half_s = PI / root;
        Self {
            compliance_ml_kpa: line.compliance_ml_kpa,
            decay,
            square,
            natural_square,
            root,
            half_swing: (exp(-decay * half_s), half_s),
        }
    }
}

/// The volume that an outlet line holds too much while it comes to rest, C p, as it swings or creeps to 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct RingDown {
    of: Decay,
    /// Volume at first, mL, and its rate of change, mL/s.
    first_ml: f64,
    rate_ml_s: f64,
}

impl RingDown {
    /// Makes the way to rest of a line from `state`.
    pub(super) fn new(of: &Decay, state: LineState) -> Self {
        let first_ml = of.compliance_ml_kpa * state.above_reservoir_kpa;
        Self { of: *of, first_ml, rate_ml_s: -state.flow_ml_s }
    }

    /// Returns the time at which the volume turns first, s, and the volume there, mL. `None` if the line creeps
    /// to rest without a turn.
    fn turn(&self) -> Option<(f64, f64)> {
        let Self { first_ml, rate_ml_s, of: Decay { decay, square, natural_square, root: swing, .. } } =
            *self;
        if square > 0.0 {
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
        let Decay { decay, natural_square, root: spread, .. } = self.of;
        let fast = decay + spread;
        let slow = natural_square / fast;
        let gap = fast - slow;
        let slow_ml = (self.rate_ml_s + fast * self.first_ml) / gap;
        [(slow, slow_ml), (fast, self.first_ml - slow_ml)]
    }

    /// Returns the largest volume below zero that the line comes to hold, mL, not negative. The line takes it
    /// back from the vessel. `direction` is 1 for a dose forward and -1 for one in reverse, which counts
    /// mirrored.
    pub(super) fn taken_back_ml(&self, direction: f64) -> f64 {
        let first_ml = (-direction * self.first_ml).max(0.0);
        let Some((_, turn_ml)) = self.turn() else { return first_ml };
        let later_ml = if self.of.square > 0.0 { -turn_ml * self.of.half_swing.0 } else { 0.0 };
        first_ml.max(-direction * turn_ml).max(-direction * later_ml)
    }

    /// Returns about the time after which the volume stays below [`SETTLED_ML`] either way, s. Between two
    /// turns the volume counts as a cosine.
    pub(super) fn settled_after_s(&self) -> f64 {
        let below = |ml: f64| ml.abs() <= SETTLED_ML;
        if self.of.square <= 0.0 {
            let [slow, fast] = self.modes().map(|(rate, ml)| log(ml.abs() / SETTLED_ML).max(0.0) / rate);
            return slow.max(fast);
        }
        let Some((time_s, turn_ml)) = self.turn() else { return 0.0 };
        let (left, half_s) = self.of.half_swing;
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
        // A line damped almost critically creeps from its turn, as (1 + s t) e^(-s t).
        let crept_s = (log(last_ml / SETTLED_ML) + 1.5) / self.of.decay;
        last_s + (acos(SETTLED_ML / last_ml) * half_s / PI).min(crept_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Follows the line in small steps, by the midpoint rule.
    fn followed(line: &Line, state: LineState) -> (f64, f64) {
        let (mut p, mut q) = (state.above_reservoir_kpa, state.flow_ml_s);
        let h = 1e-5;
        let (mut least_ml, mut settled_s) = (0.0_f64, 0.0);
        for n in 0..400_000 {
            let ml = line.compliance_ml_kpa * p;
            least_ml = least_ml.min(ml);
            if ml.abs() > SETTLED_ML {
                settled_s = f64::from(n) * h;
            }
            let rates = |p: f64, q: f64| {
                (-q / line.compliance_ml_kpa, (p - line.resistance_kpa_s_ml * q) / line.inertance_kpa_s2_ml)
            };
            let (dp, dq) = rates(p, q);
            let (dp, dq) = rates(p + 0.5 * h * dp, q + 0.5 * h * dq);
            (p, q) = (p + h * dp, q + h * dq);
        }
        (-least_ml, settled_s)
    }

    #[test]
    fn what_a_line_takes_back_and_when_it_is_settled_are_those_of_small_steps() {
        let lines = [0.1108, 0.0, 0.6, 0.682, 2.0]
            .map(|resistance_kpa_s_ml| Line { resistance_kpa_s_ml, ..Line::PUBLISHED });
        for line in lines {
            for (above_reservoir_kpa, flow_ml_s) in [(0.5, 5.0), (-0.4, 1.0), (0.02, -0.3), (0.0, 3.0)] {
                let state = LineState { above_reservoir_kpa, flow_ml_s };
                let (taken_ml, settled_s) = followed(&line, state);
                let down = RingDown::new(&Decay::new(&line), state);
                let near = (down.taken_back_ml(1.0) - taken_ml).abs();
                assert!(near < 1e-4 * (1.0 + taken_ml), "{line:?} {state:?}: {taken_ml}");
                let beside_s = (down.settled_after_s() - settled_s).abs();
                // An undamped line never settles. Otherwise the time is known to a part of a swing.
                assert!(
                    line.resistance_kpa_s_ml == 0.0 || beside_s < 0.03,
                    "{line:?} {state:?}: {settled_s}"
                );
            }
        }
    }
}
