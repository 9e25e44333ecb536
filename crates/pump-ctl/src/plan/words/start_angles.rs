//! The start angles at which a plan looks: pressures, ripple and limits depend on where the rollers stand.

use libm::ceil;

use super::phase::Phase;

/// Looks over a pitch. Neighbouring looks stand a sixteenth of a pitch apart at most.
const LOOKS_A_PITCH: f64 = 16.0;

impl Phase {
    /// Returns the offsets from this angle, rad, at which a plan looks at the rollers. They are both ends of
    /// the range in which the rollers may stand, its middle, and angles between them a sixteenth of a pitch
    /// apart at most. A known angle has the offset 0 alone.
    pub(in crate::plan) fn beside(&self, pitch_rad: f64) -> impl Iterator<Item = f64> + use<> {
        let half_rad = self.half_width_rad.min(0.5 * pitch_rad);
        // There are 8 looks a side at most.
        let looks = ceil(LOOKS_A_PITCH * half_rad / pitch_rad) as i32;
        (-looks..=looks).map(move |n| if n == 0 { 0.0 } else { half_rad * f64::from(n) / f64::from(looks) })
    }
}
