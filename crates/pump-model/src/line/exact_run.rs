//! The exact solution of one port over a motion.

use crate::error::ModelError;
use crate::head::flow_curve::FlowCurve;
use crate::motion::flow::Flow;
use crate::motion::leg::Leg;
use crate::motion::stretches::{Stretch, Stretches};
use crate::port::Port;

use super::extremes::Extremes;
use super::fine_steps::FineSteps;
use super::line::Line;
use super::line_state::LineState;
use super::oscillator::{Balanced, Oscillator};
use super::settling::settling_s;
use crate::work::{Work, count};

/// The exact solution of one port of the flow-centric model, over any motion in legs of constant
/// acceleration.
///
/// Between two edges the model is linear and the flow a polynomial of time (see `propagator.rs`). Rounding is
/// the only error.
///
/// ```
/// use pump_model::{ExactRun, Leg, Port, Pump};
/// let pump = Pump::three_roller();
/// let legs = [Leg::constant_speed(0.0, 10.471_975_511_965_978)];
/// let mut run = ExactRun::from_rest(&pump, Port::Outlet, legs);
/// assert!((run.extremes(10.0).max_kpa - 108.568_444).abs() < 1e-6);
/// ```
#[derive(Debug, Clone)]
pub struct ExactRun<'a, M> {
    pub(crate) line: &'a Line,
    pub(crate) oscillator: Oscillator,
    pub(crate) stretches: Stretches<'a, M>,
    pub(crate) stretch: Stretch,
    /// Flow at the rollers over time since the stretch's start.
    pub(crate) flow: Flow,
    /// Time reached since the stretch's start, s, and the state there.
    pub(crate) reached_s: f64,
    pub(crate) state: Balanced,
}

impl<'a, M: Iterator<Item = Leg>> ExactRun<'a, M> {
    /// Starts in `state` when the first of the `legs` starts, on any line that the flow curve of `port`
    /// drives.
    pub(crate) fn on(
        line: &'a Line,
        curve: &'a FlowCurve,
        port: Port,
        legs: impl IntoIterator<IntoIter = M>,
        state: LineState,
    ) -> Self {
        let oscillator = Oscillator::new(line, port);
        let mut stretches = Stretches::new(curve, legs);
        let stretch = next_stretch(&mut stretches);
        let (flow, state) = (stretch.flow(), oscillator.balanced(state.numbers()));
        Self { line, oscillator, stretches, stretch, flow, reached_s: 0.0, state }
    }

    /// Returns the time reached, s.
    pub fn time_s(&self) -> f64 {
        self.stretch.start_s + self.reached_s
    }

    /// Returns the state reached.
    pub fn state(&self) -> LineState {
        LineState::of(self.oscillator.physical(self.state))
    }

    /// Goes on to `t_s` and returns the state there. A time in the past gives the state reached.
    pub fn at(&mut self, t_s: f64) -> LineState {
        while t_s > self.stretch.end_s {
            self.finish_stretch();
        }
        self.go_on(t_s - self.time_s());
        self.state()
    }

    /// Goes on to `t_s` as [`Self::at`] does, and asks at each edge on the way whether to go on. Returns none if
    /// it stopped there.
    #[cfg(feature = "identification")]
    pub(crate) fn at_while(&mut self, t_s: f64, goes_on: &impl Fn() -> bool) -> Option<LineState> {
        while t_s > self.stretch.end_s {
            self.finish_stretch();
            if !goes_on() {
                return None;
            }
        }
        Some(self.at(t_s))
    }

    /// Goes on to `t_s` as [`Self::at`] does and returns the pressure there, kPa absolute.
    pub fn pressure_kpa(&mut self, t_s: f64) -> f64 {
        self.at(t_s).pressure_kpa(self.line)
    }

    /// Goes on to `end_s` and returns the smallest and largest pressure on the way, kPa absolute.
    pub fn extremes(&mut self, end_s: f64) -> Extremes {
        self.extremes_by(&mut FineSteps::new(&self.oscillator), end_s)
    }

    /// Goes on to `end_s` as [`Self::extremes`] does, by fine steps of this line.
    pub(crate) fn extremes_by(&mut self, steps: &mut FineSteps, end_s: f64) -> Extremes {
        let mut extremes = Extremes::at(self.state[0]);
        while self.time_s() < end_s {
            self.follow_fine_steps(steps, end_s, &mut extremes);
            let (before, flow) = (self.state, self.flow.shifted(self.reached_s));
            let (length_s, is_last) = self.fine_step(end_s);
            extremes.cover(self.state[0]);
            self.oscillator.turns(length_s, before, self.state, &flow, |kpa| extremes.cover(kpa));
            if is_last && !self.enters_next(end_s) {
                break;
            }
        }
        extremes.above(self.line.reservoir_kpa)
    }

    /// Goes on to `end_s` and returns the smallest and largest pressure from now on for ever, kPa absolute.
    /// The motion must be over at `end_s`.
    ///
    /// The energy of a line left alone only falls, so its first swing is its widest.
    pub fn extremes_to_rest(&mut self, end_s: f64) -> Extremes {
        let mut steps = FineSteps::new(&self.oscillator);
        let moving = self.extremes_by(&mut steps, end_s);
        moving.and(self.extremes_by(&mut steps, end_s + self.oscillator.widest_swing_s()))
    }

    /// Returns the time after which the undelivered volume |C p| stays below [`crate::SETTLED_ML`], s. The
    /// rotor rests from now on.
    ///
    /// # Errors
    ///
    /// Returns [`ModelError::NeverSettles`] if the line swings or creeps for too long.
    pub fn settling_s(&self) -> Result<f64, ModelError> {
        settling_s(&self.oscillator, self.line.compliance_ml_kpa, self.state)
    }

    /// Goes on inside the stretch by a step short beside the swing, at most to `end_s`. Returns its length, s,
    /// and true if it reaches `end_s` or the end of the stretch.
    pub(crate) fn fine_step(&mut self, end_s: f64) -> (f64, bool) {
        let stretch_s = self.stretch.end_s - self.stretch.start_s;
        let room_s = (end_s - self.stretch.start_s).min(stretch_s) - self.reached_s;
        let wanted_s = self.oscillator.fine_step_s(self.reached_s, stretch_s);
        let length_s = wanted_s.min(room_s);
        self.go_on(length_s);
        (length_s, wanted_s >= room_s)
    }

    /// Goes on into the next stretch and returns true, unless this one lasts beyond `end_s`.
    pub(crate) fn enters_next(&mut self, end_s: f64) -> bool {
        let enters = end_s >= self.stretch.end_s;
        if enters {
            self.finish_stretch();
        }
        enters
    }

    /// Returns the line's compliance, mL/kPa.
    pub(crate) fn compliance_ml_kpa(&self) -> f64 {
        self.line.compliance_ml_kpa
    }

    /// Goes on inside the stretch.
    pub(crate) fn go_on(&mut self, length_s: f64) {
        if length_s > 0.0 {
            count(Work::Step);
            self.state = self.oscillator.after(length_s, self.state, &self.flow.shifted(self.reached_s));
            self.reached_s += length_s;
        }
    }

    /// Goes on to the end of the stretch and into the next.
    pub(crate) fn finish_stretch(&mut self) {
        let next = next_stretch(&mut self.stretches);
        self.enter(next);
    }

    /// Goes on to the end of the stretch and into `next`, which follows it.
    pub(crate) fn enter(&mut self, next: Stretch) {
        self.go_on(self.stretch.end_s - self.time_s());
        self.begin(next);
    }

    /// Begins the `next` stretch in the state reached, which must be that at its start.
    pub(crate) fn begin(&mut self, next: Stretch) {
        self.stretch = next;
        self.flow = next.flow();
        self.reached_s = 0.0;
    }
}

/// Returns the next stretch. There always is one: the last is the rest that never ends.
pub(crate) fn next_stretch<M: Iterator<Item = Leg>>(stretches: &mut Stretches<'_, M>) -> Stretch {
    let after_s = stretches.time_s();
    stretches.next().unwrap_or_else(|| Stretch::rest(after_s))
}
