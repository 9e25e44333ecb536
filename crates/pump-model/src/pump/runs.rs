//! Exact runs of a pump's own lines.

use crate::line::exact_run::ExactRun;
use crate::line::line_state::LineState;
use crate::motion::leg::Leg;
use crate::port::Port;

use super::pump::Pump;

impl<'a, M: Iterator<Item = Leg>> ExactRun<'a, M> {
    /// Starts in `state` when the first of the `legs` starts. After the last leg the rotor rests.
    pub fn new(pump: &'a Pump, port: Port, legs: impl IntoIterator<IntoIter = M>, state: LineState) -> Self {
        Self::on(pump.line(port), pump.curve(port), port, legs, state)
    }

    /// Starts with the line at rest: P = P_res, no flow.
    pub fn from_rest(pump: &'a Pump, port: Port, legs: impl IntoIterator<IntoIter = M>) -> Self {
        Self::new(pump, port, legs, LineState::AT_REST)
    }
}
