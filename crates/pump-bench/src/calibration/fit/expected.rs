//! Uncertainty that runs are expected to have before they are looked at.

/// Uncertainty that is expected of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Expected {
    /// Standard deviation of repeated runs, as a part of the volume.
    pub repeatability: f64,
    /// Standard uncertainty of a reading of the scale or the vessel, in mL. It may be the same in every run,
    /// so no mean reduces it.
    pub reading_ml: f64,
}
