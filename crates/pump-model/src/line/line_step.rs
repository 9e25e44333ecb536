//! The state of a line after a time step.

use crate::head::port::Port;

use super::line::Line;
use super::line_state::LineState;
use super::oscillator::Oscillator;
use super::propagator::Propagator;

/// The change of an outlet line's state over a time step with a constant flow at the rollers.
///
/// The change by the state is exact. A flow that is not constant counts by its mean over the step.
///
/// ```
/// use pump_model::{Line, LineState, LineStep};
///
/// let step = LineStep::new(&Line::PUBLISHED, 0.004);
/// let mut state = LineState::AT_REST;
/// for _ in 0..500 {
///     state = step.after(state, 5.0);
/// }
/// // After two seconds the line carries the flow, and R Q drives it.
/// assert!((state.flow_ml_s - 5.0).abs() < 1e-9);
/// assert!((state.above_reservoir_kpa - 5.0 * Line::PUBLISHED.resistance_kpa_s_ml).abs() < 1e-9);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineStep {
    oscillator: Oscillator,
    propagator: Propagator,
}

impl LineStep {
    /// Makes the step of an outlet `line` over `step_s`, s.
    pub fn new(line: &Line, step_s: f64) -> Self {
        let oscillator = Oscillator::new(line, Port::Outlet);
        Self { oscillator, propagator: Propagator::new(&oscillator, step_s, 0) }
    }

    /// Returns the state a step after `state`, with a flow of `flow_ml_s` at the rollers.
    pub fn after(&self, state: LineState, flow_ml_s: f64) -> LineState {
        let before = self.oscillator.balanced(state.numbers());
        LineState::of(self.oscillator.physical(self.propagator.constant(before, flow_ml_s)))
    }
}
