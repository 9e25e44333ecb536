//! A pump with another pulse. The demo in the browser compiles this file too, so it needs neither std nor this crate.

use pump_model::units::degrees;
use pump_model::{ModelError, Pump};

/// Standard uncertainty of the engagement angle, in deg: read to 1 deg either way, rectangular, 1/sqrt(3) (GUM,
/// JCGM 100:2008, 4.3.7). Two sets of dimensions of the paper's one pump differ by 0.7 deg in the angle of full
/// contact, 66.8 and 66.1 deg.
pub(super) const ENGAGEMENT_DEG: f64 = 0.577;

/// Returns the corrected `pump` with `more_ml` of roller volume and `more_deg` of engagement angle. `zero_rad` is the
/// angle of the model at which the corrected pump's angles begin.
///
/// # Errors
///
/// [`ModelError`] of a pulse that no head can have.
pub(super) fn other_pump(
    pump: &Pump,
    more_ml: f64,
    more_deg: f64,
    zero_rad: f64,
) -> Result<Pump, ModelError> {
    // A corrected pump has scaled curves that begin at its zero. Its dimensions, where they are known, are those of
    // the model.
    let geometry = pump.geometry();
    let factor = if geometry.is_known() { pump.nominal_ml_rad() / geometry.nominal_ml_rad() } else { 1.0 };
    let roller = pump.roller_volume();
    let engagement_deg = degrees(roller.engagement_rad()) + more_deg;
    let total_ml = (roller.total_ml() + more_ml) / factor;
    let roller = roller.stretched_to(engagement_deg)?.scaled_to(total_ml)?;
    pump.with_roller_volume(roller)?.scaled(factor)?.shifted(zero_rad)
}
