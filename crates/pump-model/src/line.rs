//! The hydraulic line of one port: what stands between the rollers and the reservoir.

use crate::error::{ModelError, positive};
use crate::math::sqrt;

/// Lumped line of one port (section 2.4 of McIntyre et al.): C at the pump, R and L in series to a reservoir.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// R, kPa s/mL, not negative.
    pub resistance_kpa_s_ml: f64,
    /// C, mL/kPa, positive.
    pub compliance_ml_kpa: f64,
    /// L, kPa s²/mL, positive.
    pub inertance_kpa_s2_ml: f64,
    /// P_res, kPa absolute, positive.
    pub reservoir_kpa: f64,
}

impl Line {
    /// The line of McIntyre et al., Table 2, the same at inlet and outlet.
    pub const PUBLISHED: Self = Self {
        resistance_kpa_s_ml: 0.1108,
        compliance_ml_kpa: 0.0361,
        inertance_kpa_s2_ml: 0.0042,
        reservoir_kpa: 88.637,
    };

    /// Refuses a line that is not physical.
    pub fn validate(&self) -> Result<(), ModelError> {
        if !(self.resistance_kpa_s_ml.is_finite() && self.resistance_kpa_s_ml >= 0.0) {
            return Err(ModelError::OutOfRange {
                parameter: "line resistance in kPa s/mL",
                value: self.resistance_kpa_s_ml,
                allowed: "zero or a positive number",
            });
        }
        positive("line compliance in mL/kPa", self.compliance_ml_kpa)?;
        positive("line inertance in kPa s2/mL", self.inertance_kpa_s2_ml)?;
        positive("reservoir pressure in kPa absolute", self.reservoir_kpa)
    }

    /// Undamped natural frequency 1 / sqrt(L C), rad/s.
    pub fn natural_rad_s(&self) -> f64 {
        1.0 / sqrt(self.inertance_kpa_s2_ml * self.compliance_ml_kpa)
    }

    /// Damping ratio R/2 sqrt(C/L).
    ///
    /// ```
    /// assert!((pump_model::Line::PUBLISHED.damping_ratio() - 0.162).abs() < 5e-4);
    /// ```
    pub fn damping_ratio(&self) -> f64 {
        0.5 * self.resistance_kpa_s_ml * sqrt(self.compliance_ml_kpa / self.inertance_kpa_s2_ml)
    }

    /// Flow that carries as much energy as 1 kPa of pressure: sqrt(C/L), mL/s.
    pub(crate) fn flow_scale_ml_s(&self) -> f64 {
        sqrt(self.compliance_ml_kpa / self.inertance_kpa_s2_ml)
    }
}
