//! The safety limits of a pump.

/// Safety limits of a pump. `None` limits nothing.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct SafetyLimits {
    /// Most volume in any 24 hours, in mL, in either direction.
    pub max_ml_per_day: Option<f64>,
    /// Volume that the receiving vessel holds, in mL.
    pub vessel_ml: Option<f64>,
}

impl SafetyLimits {
    /// Names the limits. `None` limits nothing.
    pub fn new(max_ml_per_day: Option<f64>, vessel_ml: Option<f64>) -> Self {
        Self { max_ml_per_day, vessel_ml }
    }
}
