//! The volume that a motion leaves in the lines, and what comes of it.

use pump_model::Line;

use super::lines::{Lines, States};

/// The back flow and the settling time that follow from ramps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Outcome {
    /// Largest back flow of the lines that may be, mL.
    pub(super) taken_back_ml: f64,
    /// Motion, and settling as the mean over the lines that may be, s. Beyond the limit of the back flow it is the
    /// motion alone.
    pub(super) time_s: f64,
    /// Largest back flow that is no fault, mL.
    pub(super) limit_ml: f64,
}

/// Largest back flow of any dose that is no fault, mL. It is about the volume of one motor step of the built-in pumps
/// (1.7 uL), in which a dose is known.
const MOST_ML: f64 = 2e-3;

/// Part of a small dose's volume that is no fault.
const PART: f64 = 0.01;

/// Returns the largest back flow that is no fault, mL, of a dose of `volume_ml` in steps of `step_ml`: a hundredth of
/// the dose, and never less than half a step, in which the end of every dose is known.
pub(super) fn limit_ml(volume_ml: f64, step_ml: f64) -> f64 {
    (PART * volume_ml.abs()).max(0.5 * step_ml).min(MOST_ML)
}

impl Outcome {
    /// Returns true if these ramps are to be preferred: they are sooner within the limit of the back flow, or
    /// take back less beyond it.
    pub(super) fn is_better_than(&self, other: &Self) -> bool {
        match (self.is_within(), other.is_within()) {
            (true, true) => self.time_s < other.time_s,
            (false, false) => self.taken_back_ml < other.taken_back_ml,
            (within, _) => within,
        }
    }

    /// Returns true if the back flow is no fault.
    pub(super) fn is_within(&self) -> bool {
        self.taken_back_ml <= self.limit_ml
    }
}

/// The largest volume that the vessel has received beyond the final one, during the motion.
pub(super) struct LeftOver {
    /// Direction: 1 forward, -1 in reverse.
    direction: f64,
    /// Volume at the rollers at the end, since angle 0, mL.
    end_ml: f64,
    pub(super) taken_back_ml: f64,
    /// Largest back flow that is no fault, mL.
    limit_ml: f64,
}

impl LeftOver {
    /// Starts an account of a motion in this direction that ends at this volume.
    pub(super) fn new(direction: f64, end_ml: f64, limit_ml: f64) -> Self {
        Self { direction, end_ml, taken_back_ml: 0.0, limit_ml }
    }

    /// Takes note of a moment of the motion.
    pub(super) fn note(&mut self, rollers_ml: f64, states: &States, lines: &[Line; 3]) {
        for (state, line) in states.iter().zip(lines) {
            let received_ml = rollers_ml - line.compliance_ml_kpa * state.above_reservoir_kpa;
            self.taken_back_ml = self.taken_back_ml.max(self.direction * (received_ml - self.end_ml));
        }
    }

    /// Returns the outcome of a motion of `motion_s` that ends with the lines in `states`. `None` if it takes back
    /// more than the limit and more than `most_ml`.
    ///
    /// The last step comes at once, so the step's volume is in the line at first, as where a plan predicts its
    /// settling.
    pub(super) fn outcome(
        self,
        lines: &Lines,
        states: &States,
        motion_s: f64,
        step_ml: f64,
        most_ml: f64,
    ) -> Option<Outcome> {
        let limit_ml = self.limit_ml;
        let most_ml = most_ml.max(limit_ml);
        let mut taken_back_ml = self.taken_back_ml;
        for down in lines.ring_down(states) {
            if taken_back_ml > most_ml {
                return None;
            }
            taken_back_ml = taken_back_ml.max(down.taken_back_ml(self.direction));
        }
        if taken_back_ml > limit_ml {
            // The time does not count beyond the limit.
            return (taken_back_ml <= most_ml).then_some(Outcome {
                taken_back_ml,
                time_s: motion_s,
                limit_ml,
            });
        }
        let stepped = lines.with_volume(states, step_ml);
        let (mut settled_s, mut count) = (0.0, 0.0);
        for down in lines.ring_down(&stepped) {
            settled_s += down.settled_after_s();
            count += 1.0;
        }
        Some(Outcome { taken_back_ml, time_s: motion_s + settled_s / count, limit_ml })
    }
}
