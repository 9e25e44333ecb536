//! The state of a line with its derivatives.

use crate::line::line_state::LineState;

use super::parameter::SensitivityParameter;

/// State of a line and its derivatives by each [`SensitivityParameter`], in the order of
/// [`SensitivityParameter::ALL`].
///
/// ```
/// use pump_model::{SensitiveState, SensitivityParameter};
///
/// let rest = SensitiveState::AT_REST;
/// assert_eq!(rest.pressure_by[SensitivityParameter::Inertance.index()], 0.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SensitiveState {
    /// State of the line.
    pub state: LineState,
    /// Derivatives of the pressure at the port, kPa over the unit of each parameter.
    pub pressure_by: [f64; SensitivityParameter::COUNT],
    /// Derivatives of the flow in the line, mL/s over the unit of each parameter.
    pub flow_by: [f64; SensitivityParameter::COUNT],
}

impl SensitiveState {
    /// State of a line at rest, which depends on no parameter.
    pub const AT_REST: Self = Self::fixed(LineState::AT_REST);

    /// Makes a state that is given, so that it depends on no parameter.
    pub const fn fixed(state: LineState) -> Self {
        Self {
            state,
            pressure_by: [0.0; SensitivityParameter::COUNT],
            flow_by: [0.0; SensitivityParameter::COUNT],
        }
    }
}
