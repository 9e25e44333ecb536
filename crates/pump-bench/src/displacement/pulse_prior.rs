//! The default pulse of a head that is known by its volume alone, with the spread that drawings of heads leave.

use libm::exp;
use pump_model::units::radians;
use pump_model::{DefaultPulse, ModelError, RollerVolume};

/// Geometric mean of the engagement angles of the drawings, in deg (`examples/pulse_prior`, as all figures here).
const ENGAGEMENT_DEG: f64 = 61.016;

/// Twice the standard deviation of the logarithms of these angles.
const ENGAGEMENT_SPREAD: f64 = 0.4591;

/// Mean of V_r/(a phi) over the drawings.
const FULLNESS: f64 = 0.42185;

/// Twice the standard deviation of V_r/(a phi).
const FULLNESS_STANDARD: f64 = 0.09936;

/// Largest engagement angle of the drawings, as a part of the pitch. More rollers leave less room for each.
const WIDEST_PART: f64 = 0.6167;

/// Default pulse of a head of which the number of rollers is known, with its standard uncertainties.
///
/// ```
/// use pump_bench::displacement::PulsePrior;
/// let prior = PulsePrior::of(4);
/// // The share of a pitch is the fullness times the part of the pitch that the pulse takes.
/// assert!((prior.share() - prior.fullness * prior.engagement_deg / 90.0).abs() < 1e-15);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct PulsePrior {
    /// Number of rollers.
    pub rollers: u32,
    /// Engagement angle phi, in deg: the middle of its logarithms.
    pub engagement_deg: f64,
    /// Standard uncertainty of the logarithm of phi.
    pub engagement_spread: f64,
    /// Fullness V_r/(a phi): the part of the bore's volume over phi that a roller takes.
    pub fullness: f64,
    /// Standard uncertainty of the fullness.
    pub fullness_standard: f64,
}

impl PulsePrior {
    /// Returns the default pulse of a head with this number of rollers.
    pub fn of(rollers: u32) -> Self {
        let pitch_deg = 360.0 / f64::from(rollers.max(1));
        Self {
            rollers,
            engagement_deg: ENGAGEMENT_DEG.min(WIDEST_PART * pitch_deg),
            engagement_spread: ENGAGEMENT_SPREAD,
            fullness: FULLNESS,
            fullness_standard: FULLNESS_STANDARD,
        }
    }

    /// Returns the share of the bore's volume of a pitch that a roller takes.
    pub fn share(&self) -> f64 {
        self.fullness * self.engagement_deg * f64::from(self.rollers) / 360.0
    }

    /// Returns the pulse of the model.
    pub fn pulse(&self) -> DefaultPulse {
        self.pulse_at([0.0, 0.0])
    }

    /// Returns the pulse that lies `sigmas` standard uncertainties from the default, in ln phi and in fullness. No head
    /// has a pulse longer than a turn, or one that takes nothing or all of the pitch: such a pulse is brought within 5
    /// % of the bore's flow and 95 % of its volume.
    pub(crate) fn pulse_at(&self, [angle, fullness]: [f64; 2]) -> DefaultPulse {
        let engagement_deg = (self.engagement_deg * exp(self.engagement_spread * angle)).min(330.0);
        let fullness = (self.fullness + self.fullness_standard * fullness).max(0.05);
        let share = fullness * engagement_deg * f64::from(self.rollers) / 360.0;
        DefaultPulse::new(share.min(0.95), engagement_deg)
    }

    /// Returns the roller's volume of [`Self::pulse_at`] in a head that delivers `pitch_ml` a pitch.
    ///
    /// # Errors
    ///
    /// [`ModelError`] of a volume that is not positive.
    pub(crate) fn roller_volume_at(
        &self,
        pitch_ml: f64,
        sigmas: [f64; 2],
    ) -> Result<RollerVolume, ModelError> {
        self.pulse_at(sigmas).roller_volume(pitch_ml)
    }

    /// Returns the covariances of V_r, as a part of it, and of phi, in rad: V_r goes as fullness times phi.
    pub(crate) fn covariances(&self) -> [[f64; 2]; 2] {
        let (phi_rad, of_angle) =
            (radians(self.engagement_deg), self.engagement_spread * self.engagement_spread);
        let of_fullness = self.fullness_standard / self.fullness;
        [
            [of_angle + of_fullness * of_fullness, of_angle * phi_rad],
            [of_angle * phi_rad, of_angle * phi_rad * phi_rad],
        ]
    }
}
