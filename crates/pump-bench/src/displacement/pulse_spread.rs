//! The spread of the default pulse that drawings of heads leave (`examples/pulse_prior`, as all figures here). The demo
//! in the browser compiles this file too, so it needs neither std nor this crate.

use pump_model::DefaultPulse;
use pump_model::units::radians;

/// Twice the standard deviation of the logarithms of the drawings' engagement angles.
pub(crate) const ENGAGEMENT_SPREAD: f64 = 0.5037;

/// Twice the standard deviation of V_r/(a phi).
pub(crate) const FULLNESS_STANDARD: f64 = 0.11025;

/// Returns the covariances of V_r, as a part of it, and of phi, in rad, of the default pulse of a head with this number
/// of rollers: V_r goes as fullness times phi.
pub(crate) fn covariances(rollers: u32) -> [[f64; 2]; 2] {
    let phi_rad = radians(DefaultPulse::usual_engagement_deg(rollers));
    let of_angle = ENGAGEMENT_SPREAD * ENGAGEMENT_SPREAD;
    let of_fullness = FULLNESS_STANDARD / DefaultPulse::FULLNESS;
    [
        [of_angle + of_fullness * of_fullness, of_angle * phi_rad],
        [of_angle * phi_rad, of_angle * phi_rad * phi_rad],
    ]
}
