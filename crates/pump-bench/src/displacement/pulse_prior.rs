//! The default pulse of a head that is known by its volume alone, with the spread that the drawings of heads leave.

use pump_model::DefaultPulse;

/// Default pulse of a head of which the number of rollers is known, with its standard uncertainties.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct PulsePrior {
    /// Share of the bore's volume between two rollers that a roller takes.
    pub share: f64,
    /// Standard uncertainty of the share.
    pub share_standard: f64,
    /// Engagement angle phi, in deg.
    pub engagement_deg: f64,
    /// Standard uncertainty of phi, in deg.
    pub engagement_standard_deg: f64,
}

impl PulsePrior {
    /// Returns the default pulse of a head with this number of rollers.
    pub fn of(rollers: u32) -> Self {
        let pitch_deg = 360.0 / f64::from(rollers.max(1));
        Self {
            share: 0.2,
            share_standard: 0.05,
            engagement_deg: 0.5 * pitch_deg,
            engagement_standard_deg: 0.1 * pitch_deg,
        }
    }

    /// Returns the pulse of the model.
    pub fn pulse(&self) -> DefaultPulse {
        DefaultPulse::new(self.share, self.engagement_deg)
    }
}
