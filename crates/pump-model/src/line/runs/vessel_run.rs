//! The volume that a vessel at the line's end receives, and what the line takes back of it.

use crate::error::ModelError;
use crate::math::hermite::{self, End};
use crate::math::polynomial::Polynomial;
use crate::motion::flow::Flow;
use crate::motion::leg::Leg;

use crate::line::exact_run::ExactRun;
use crate::line::oscillator::{Balanced, Oscillator};

/// Volume that may still move at the end of a run to rest, mL: 1 nL.
const STILL_ML: f64 = 1e-6;

/// Time after which a line counts as never coming to rest, s.
const LIMIT_S: f64 = 3600.0;

/// Length of a step beyond which only slow parts of the state are left, in units of 1/|A|.
const LONG: f64 = 10.0;

/// Volume that a line takes back from the vessel at its end.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct BackFlow {
    /// Largest volume delivered less the final one, mL. It is 0 or more.
    pub backflow_ml: f64,
    /// All that the line takes back on the way, mL. It is at least the back flow.
    pub reverse_flow_ml: f64,
}

impl BackFlow {
    /// Returns the larger of both volumes, each for itself.
    #[must_use]
    pub fn worst(self, other: Self) -> Self {
        Self {
            backflow_ml: self.backflow_ml.max(other.backflow_ml),
            reverse_flow_ml: self.reverse_flow_ml.max(other.reverse_flow_ml),
        }
    }
}

/// An exact run that keeps account of the volume that the vessel at the line's end receives.
///
/// The line stores C p, so the vessel has received the rollers' volume less the change of C p. That volume
/// turns where the flow at the line's end changes sign. The runs to these instants are exact.
#[derive(Debug, Clone)]
pub struct VesselRun<'a, M> {
    run: ExactRun<'a, M>,
    /// 1 for a dose forward, -1 for one in reverse, which counts mirrored.
    direction: f64,
    received_ml: f64,
    most_ml: f64,
    taken_back_ml: f64,
}

impl<'a, M: Iterator<Item = Leg>> VesselRun<'a, M> {
    /// Starts at the state that `run` has reached. `is_forward` tells the direction of the dose.
    pub fn new(run: ExactRun<'a, M>, is_forward: bool) -> Self {
        let direction = if is_forward { 1.0 } else { -1.0 };
        Self { run, direction, received_ml: 0.0, most_ml: 0.0, taken_back_ml: 0.0 }
    }

    /// Returns the volume received so far, mL. In reverse it is the volume given.
    pub fn received_ml(&self) -> f64 {
        self.received_ml
    }

    /// Returns all that was taken back so far, mL.
    pub fn reverse_flow_ml(&self) -> f64 {
        self.taken_back_ml
    }

    /// Goes on to `end_s`.
    pub fn go_to(&mut self, end_s: f64) {
        while self.run.time_s() < end_s && self.step(end_s) {}
    }

    /// Goes on to `end_s`, at which the motion must be over, and on until the line rests. Returns what the
    /// line took back from the start of this account on.
    ///
    /// # Errors
    ///
    /// Returns [`ModelError::NeverSettles`] if the line swings or creeps for too long.
    pub fn back_flow_to_rest(mut self, end_s: f64) -> Result<BackFlow, ModelError> {
        self.go_to(end_s);
        let still_kpa = STILL_ML / self.run.compliance_ml_kpa();
        loop {
            // The energy of a line left alone only falls.
            let [x, y] = self.run.state;
            if x * x + y * y <= still_kpa * still_kpa {
                break;
            }
            let waited_s = self.run.time_s() - end_s;
            if waited_s > LIMIT_S {
                return Err(ModelError::NeverSettles { waited_s });
            }
            // The step never more than doubles the time, so the time stays finite.
            self.step(end_s + 2.0 * waited_s + 1.0);
        }
        let backflow_ml = (self.most_ml - self.received_ml).max(0.0);
        Ok(BackFlow { backflow_ml, reverse_flow_ml: self.taken_back_ml.max(backflow_ml) })
    }

    /// Goes on by a step short beside the swing, at most to `end_s`. Returns false if it ends there.
    fn step(&mut self, end_s: f64) -> bool {
        let oscillator = self.run.oscillator;
        let (before, flow) = (self.run.state, self.run.flow.shifted(self.run.reached_s));
        let (length_s, is_last) = self.run.fine_step(end_s);
        let (direction, sign, compliance) =
            (self.direction, oscillator.rate.signum(), self.run.compliance_ml_kpa());
        let received_by = |t: f64, state: Balanced| {
            direction * (flow.volume(t) - sign * compliance * (state[0] - before[0]))
        };
        let after = self.run.state;
        let mut last_ml = 0.0;
        let mut note = |ml: f64| {
            let change_ml = ml - last_ml;
            last_ml = ml;
            self.received_ml += change_ml;
            self.most_ml = self.most_ml.max(self.received_ml);
            self.taken_back_ml += (-change_ml).max(0.0);
        };
        oscillator.flow_reversals(length_s, before, after, &flow, |t, state| note(received_by(t, state)));
        note(received_by(length_s, after));
        !is_last || self.run.enters_next(end_s)
    }
}

impl Oscillator {
    /// Reports the times within `length_s` after `before` at which the flow at the line's end changes sign,
    /// in order, with the states there, to `found`.
    ///
    /// The error of the place counts in second order only, since the volume received turns there.
    fn flow_reversals(
        &self,
        length_s: f64,
        before: Balanced,
        after: Balanced,
        flow: &Flow,
        mut found: impl FnMut(f64, Balanced),
    ) {
        if self.norm() * length_s <= LONG {
            for place in self.line_flow(length_s, before, after, flow).roots_in(0.0, 1.0).as_slice() {
                let t = place * length_s;
                found(t, self.after(t, before, flow));
            }
            return;
        }
        if before[1] * after[1] >= 0.0 {
            return;
        }
        let (mut low, mut high) = (0.0, length_s);
        for _ in 0..50 {
            let middle = 0.5 * (low + high);
            if (self.after(middle, before, flow)[1] > 0.0) == (before[1] > 0.0) {
                low = middle;
            } else {
                high = middle;
            }
        }
        found(low, self.after(low, before, flow));
    }

    /// Returns the flow at the line's end times its impedance between two states, over the fraction of the
    /// time passed, 0 to 1. `flow` counts time from `before`.
    fn line_flow(&self, length_s: f64, before: Balanced, after: Balanced, flow: &Flow) -> Polynomial {
        let end = |state: Balanced, t| {
            let slope = self.derivative(state, flow.at(t));
            let curvature = self.derivative(slope, flow.rate_at(t));
            End { value: state[1], slope: slope[1], curvature: curvature[1] }
        };
        Polynomial { c: hermite::quintic(length_s, &end(before, 0.0), &end(after, length_s)) }
    }
}
