//! Bounds that geometry sets to the pulse of a roller, whatever the head.

/// Largest part of the bore's volume that a roller takes over its own width.
///
/// A bore that is flattened by h of its diameter D is a stadium of unchanged perimeter, which has lost (h/D)² of its
/// area (`pump_model::Drawing`). A round roller that closes the bore at its middle presses by h/D <= sqrt(1 - x²) at
/// the part x of its half width. The integral of 1 - x² over x from 0 to 1 is 2/3.
const FULLEST: f64 = 2.0 / 3.0;

/// Bounds of a roller's pulse in a head of which the number of rollers is known.
///
/// ```
/// use pump_bench::displacement::PulseBounds;
/// let bounds = PulseBounds::of(4);
/// // The paper's roller: 66.81 deg, 0.4342 of the bore's volume over them.
/// assert!(bounds.hold(66.81, 0.4342));
/// // No roller takes nine tenths of the bore's volume, and none leaves over half a turn.
/// assert!(!bounds.hold(66.81, 0.9) && !bounds.hold(180.0, 0.2));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct PulseBounds {
    /// Number of rollers.
    pub rollers: u32,
    /// Longest engagement angle phi, in deg.
    ///
    /// A roller seals until the next one does: over a pitch at least. It engages over phi before and leaves over phi
    /// after, all within a turn: 2 phi + pitch <= 360 deg. A single roller seals while it engages: half a turn.
    pub longest_deg: f64,
    /// Largest fullness V_r/(a phi).
    ///
    /// All that a roller squeezes passes the end of the backplate while it leaves. Phi is thus the roller's width or
    /// more, and it takes two thirds of the bore's volume over its width at most.
    pub fullest: f64,
    /// Largest share of the bore's volume of a pitch.
    ///
    /// Rollers stand side by side, so each squeezes the tube over a pitch at most, and takes two thirds of the bore's
    /// volume there at most.
    pub largest_share: f64,
}

impl PulseBounds {
    /// Returns the bounds in a head with this number of rollers.
    pub fn of(rollers: u32) -> Self {
        let rollers = rollers.max(1);
        let longest_deg = if rollers == 1 { 180.0 } else { 180.0 * (1.0 - 1.0 / f64::from(rollers)) };
        Self { rollers, longest_deg, fullest: FULLEST, largest_share: FULLEST }
    }

    /// True for a pulse that a head can have, of an engagement angle in deg and a fullness.
    pub fn hold(&self, engagement_deg: f64, fullness: f64) -> bool {
        let share = fullness * engagement_deg * f64::from(self.rollers) / 360.0;
        engagement_deg > 0.0
            && engagement_deg <= self.longest_deg
            && fullness > 0.0
            && fullness <= self.fullest
            && share <= self.largest_share
    }
}

#[cfg(test)]
mod tests {
    use pump_model::units::{TURN_RAD, degrees};
    use pump_model::{Drawing, Geometry};

    use super::*;

    #[test]
    fn rollers_that_all_but_touch_each_other_and_the_bores_far_side_keep_the_bounds() {
        let mut most_share = 0.0_f64;
        for rollers in [2, 3, 4, 6, 8, 12] {
            for part in [0.2, 0.5, 0.8, 0.99] {
                for bore in [0.05, 0.2, 0.5, 0.8, 0.99] {
                    // Rollers of that part of the radius at which they touch, and a bore of that part of the depth at
                    // which a roller's flank would dip into it: D = d + r - sqrt(d² - r²).
                    let offset_mm = 10.0;
                    let sine = (TURN_RAD / 2.0 / f64::from(rollers)).sin();
                    let roller_mm = part * offset_mm * sine.min(0.99);
                    let inner_mm = ((offset_mm - roller_mm) * (offset_mm + roller_mm)).sqrt();
                    let depth_mm = bore * (offset_mm + roller_mm - inner_mm);
                    let wall_mm = 0.4;
                    let geometry = Geometry {
                        rollers,
                        bore_radius_mm: 0.5 * depth_mm,
                        tube_outer_radius_mm: 0.5 * depth_mm + wall_mm,
                        // A nanometre keeps rounding from opening the tube.
                        backplate_radius_mm: offset_mm + roller_mm + 2.0 * wall_mm - 1e-6,
                        contact_angle_rad: 0.6,
                        roller_radius_mm: roller_mm,
                        roller_offset_mm: offset_mm,
                    };
                    let Ok(drawing) = Drawing::new(&geometry) else { continue };
                    let phi_rad = drawing.engagement_rad();
                    // The bore's volume per radian on the roller's own arc, between the tube's inner side and its axis.
                    let nominal_ml_rad = geometry.nominal_ml_rad();
                    let fullness = drawing.volume_ml(phi_rad) / (nominal_ml_rad * phi_rad);
                    let bounds = PulseBounds::of(rollers);
                    let share = fullness * degrees(phi_rad) * f64::from(rollers) / 360.0;
                    most_share = most_share.max(share);
                    assert!(fullness < bounds.fullest, "{rollers} {part} {bore}: {fullness}");
                    assert!(share < bounds.largest_share, "{rollers} {part} {bore}: {share}");
                }
            }
        }
        assert!(most_share > 0.45, "the drawings come nowhere near the bound: {most_share}");
    }
}
