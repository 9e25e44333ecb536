//! The calibration that a dose used.

use pump_model::units::degrees;
use serde::Serialize;

use crate::calibration::{Applied, Made};

/// The calibration that a dose used.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct CalibrationReport {
    /// Number of the calibration.
    pub version: u32,
    /// Date on which the calibration was made, UTC.
    pub date: String,
    /// Factor of the calibration on the model's volumes, at the dose's cruise speed.
    pub displacement_factor: f64,
    /// Model angle of the rollers where the record says 0, deg.
    pub zero_deg: f64,
    /// Roller volume V_r that short doses found, mL; null if the pump file's holds.
    pub roller_volume_ml: Option<f64>,
    /// Engagement angle phi that short doses found, deg; null if the pump file's holds.
    pub engagement_deg: Option<f64>,
}

impl CalibrationReport {
    pub(in crate::report) fn of(applied: &Applied) -> Option<Self> {
        let Made { version, date, .. } = applied.calibration.clone()?;
        let (displacement_factor, zero_rad) = (applied.correction.factor, applied.correction.zero_rad);
        let pulse = applied.correction.pulse;
        Some(Self {
            version,
            date,
            displacement_factor,
            zero_deg: degrees(zero_rad),
            roller_volume_ml: pulse.map(|pulse| pulse.roller_volume_ml),
            engagement_deg: pulse.map(|pulse| pulse.engagement_deg),
        })
    }
}
