//! `[tube]`: the tube that the rollers squeeze.

use serde::{Deserialize, Serialize};

use crate::pump_file::range::{WrongValue, positive, within_if_given};

/// The table `[tube]`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct TubeTable {
    /// Radius of the bore r_i, in mm. `None` beside `[head]`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bore_radius_mm: Option<f64>,
    /// Outer radius r_o, in mm. `None` beside `[head]`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub outer_radius_mm: Option<f64>,
    /// Young's modulus E, in MPa. The pressure at which the tube collapses follows from it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub modulus_mpa: Option<f64>,
    /// Poisson's ratio nu, 0 to 0.5. It goes with the modulus.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub poisson_ratio: Option<f64>,
    /// Volume that a tube lasts, pumped either way, in mL. `None` if it is not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub life_ml: Option<f64>,
    /// Time in motion that a tube lasts, in h. Of several lives the first that is reached counts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub life_h: Option<f64>,
    /// Revolutions of the pump head, either way, that a tube lasts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub life_rev: Option<f64>,
}

impl TubeTable {
    /// Returns true if nothing is known of the tube.
    pub(in crate::pump_file) fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Refuses the first value outside its range, and a modulus without a ratio or a ratio without a modulus.
    pub(in crate::pump_file) fn check(&self) -> Result<(), WrongValue> {
        let lives = [
            ("[tube] life_ml", self.life_ml),
            ("[tube] life_h", self.life_h),
            ("[tube] life_rev", self.life_rev),
        ];
        for (key, life) in lives {
            life.map_or(Ok(()), |life| positive(key, life))?;
        }
        within_if_given("[tube] modulus_mpa", self.modulus_mpa, 1e-3..=1e6)?;
        within_if_given("[tube] poisson_ratio", self.poisson_ratio, 0.0..=0.5)?;
        let missing = |key| Err(WrongValue::missing(key, "a number: modulus and ratio go together"));
        match (self.modulus_mpa, self.poisson_ratio) {
            (None, Some(_)) => missing("[tube] modulus_mpa"),
            (Some(_), None) => missing("[tube] poisson_ratio"),
            _ => Ok(()),
        }
    }

    /// Returns how far the pressure inside may fall below ambient before the tube collapses, in kPa. Returns
    /// `None` if a radius, modulus or ratio is not known.
    ///
    /// The result is the critical pressure of a long thin-walled ring, E/(4 (1 - nu²)) (t/r_m)³ with wall t
    /// and mean radius r_m (Timoshenko and Gere, Theory of Elastic Stability, section 7.5). It is an
    /// estimate, since tubes for such pumps are not thin.
    pub(crate) fn collapse_below_ambient_kpa(&self) -> Option<f64> {
        const KPA_PER_MPA: f64 = 1e3;
        let (modulus_mpa, nu) = self.modulus_mpa.zip(self.poisson_ratio)?;
        let (outer_mm, bore_mm) = self.outer_radius_mm.zip(self.bore_radius_mm)?;
        let ratio = (outer_mm - bore_mm) / (0.5 * (outer_mm + bore_mm));
        Some(KPA_PER_MPA * modulus_mpa / (4.0 * (1.0 - nu * nu)) * ratio * ratio * ratio)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_papers_tube_collapses_42_65_kpa_below_ambient() {
        let tube = crate::catalogue::built_in("three-roller").unwrap().tube;
        assert!((tube.collapse_below_ambient_kpa().unwrap() - 42.647).abs() < 1e-3);
        // The wall counts in its third power: half of it over the same mean radius.
        let thin = TubeTable { bore_radius_mm: Some(5.5), outer_radius_mm: Some(6.5), ..tube.clone() };
        assert!((thin.collapse_below_ambient_kpa().unwrap() * 8.0 - 42.647).abs() < 1e-2);
        assert_eq!(TubeTable { modulus_mpa: None, ..tube }.collapse_below_ambient_kpa(), None);
    }
}
