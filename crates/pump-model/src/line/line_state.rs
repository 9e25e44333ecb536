//! The state of a line.

use super::line::Line;

/// The state of a line: the pressure at the port, above the reservoir, and the flow in the line.
///
/// ```
/// use pump_model::{Line, LineState};
///
/// let state = LineState { above_reservoir_kpa: 1.5, flow_ml_s: 0.0 };
/// assert_eq!(state.pressure_kpa(&Line::PUBLISHED), Line::PUBLISHED.reservoir_kpa + 1.5);
/// assert_eq!(LineState::AT_REST.flow_ml_s, 0.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct LineState {
    /// Pressure at the port above the reservoir, P - P_res, kPa.
    pub above_reservoir_kpa: f64,
    /// Flow in the line, mL/s, positive from inlet to outlet.
    pub flow_ml_s: f64,
}

impl LineState {
    /// State of a line at rest: P = P_res, no flow.
    pub const AT_REST: Self = Self { above_reservoir_kpa: 0.0, flow_ml_s: 0.0 };

    /// Returns the pressure at the port of `line`, kPa absolute.
    pub fn pressure_kpa(&self, line: &Line) -> f64 {
        line.reservoir_kpa + self.above_reservoir_kpa
    }

    /// Makes a state of a model's two numbers.
    #[inline]
    pub(crate) fn of([above_reservoir_kpa, flow_ml_s]: [f64; 2]) -> Self {
        Self { above_reservoir_kpa, flow_ml_s }
    }

    /// Returns the two numbers of the model.
    #[inline]
    pub(crate) fn numbers(self) -> [f64; 2] {
        [self.above_reservoir_kpa, self.flow_ml_s]
    }
}
