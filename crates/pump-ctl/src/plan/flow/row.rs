//! A row of a flow over time.

/// The flow at an instant. Between two rows the flow is linear, and two rows of one time are a step of the flow.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct FlowRow {
    /// Time since the start, s.
    pub time_s: f64,
    /// Flow at the rollers of the outlet, mL/s, negative in reverse.
    pub flow_ml_s: f64,
}

impl FlowRow {
    /// Makes a row of a time and a flow.
    pub const fn new(time_s: f64, flow_ml_s: f64) -> Self {
        Self { time_s, flow_ml_s }
    }
}

/// Row of a flow over time with its place in the plan.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct FlowKnot {
    /// Time and flow.
    pub row: FlowRow,
    /// Volume since the start, mL, without its sign.
    pub volume_ml: f64,
    /// Motor steps since the start, without their sign.
    pub steps: u64,
}
