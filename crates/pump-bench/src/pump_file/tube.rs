//! `[tube]`: what is squeezed.

use serde::{Deserialize, Serialize};

/// `[tube]`
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TubeTable {
    /// r_i, mm.
    pub bore_radius_mm: f64,
    /// r_o, mm.
    pub outer_radius_mm: f64,
    /// Young's modulus E, MPa; without it nobody knows when the tube collapses.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub modulus_mpa: Option<f64>,
    /// nu, 0 to 0.5; goes with the modulus.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub poisson_ratio: Option<f64>,
    /// Volume that a tube lasts, either way, mL; none if it is not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub life_ml: Option<f64>,
}

impl TubeTable {
    /// What is wrong with it: key, what it says, what is allowed.
    pub(super) fn wrong(&self) -> Option<(&'static str, String, &'static str)> {
        let out_of = |value: Option<f64>, range: std::ops::RangeInclusive<f64>| {
            value.filter(|value| !range.contains(value)).map(|value| value.to_string())
        };
        let missing = |key, there: bool, other: Option<f64>| {
            (!there && other.is_some())
                .then(|| (key, "missing".to_owned(), "a number: modulus and ratio go together"))
        };
        let of = |key, value: Option<String>, allowed| value.map(|value| (key, value, allowed));
        let life = self.life_ml.filter(|life_ml| !(*life_ml > 0.0 && life_ml.is_finite()));
        of("[tube] life_ml", life.map(|life_ml| life_ml.to_string()), "more than 0")
            .or_else(|| of("[tube] modulus_mpa", out_of(self.modulus_mpa, 1e-3..=1e6), "0.001 to 1000000"))
            .or_else(|| of("[tube] poisson_ratio", out_of(self.poisson_ratio, 0.0..=0.5), "0 to 0.5"))
            .or_else(|| missing("[tube] modulus_mpa", self.modulus_mpa.is_some(), self.poisson_ratio))
            .or_else(|| missing("[tube] poisson_ratio", self.poisson_ratio.is_some(), self.modulus_mpa))
    }

    /// How far below ambient the pressure inside may fall before the tube collapses, kPa; none if it is not known.
    ///
    /// The critical pressure of a long thin-walled ring, E/(4 (1 - nu²)) (t/r_m)³ with wall t and mean radius r_m
    /// (Timoshenko and Gere, Theory of Elastic Stability, section 7.5): an estimate, as tubes for such pumps are not thin.
    pub fn collapse_below_ambient_kpa(&self) -> Option<f64> {
        const KPA_PER_MPA: f64 = 1e3;
        let (modulus_mpa, nu) = self.modulus_mpa.zip(self.poisson_ratio)?;
        let wall_mm = self.outer_radius_mm - self.bore_radius_mm;
        let ratio = wall_mm / (0.5 * (self.outer_radius_mm + self.bore_radius_mm));
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
        let thin = TubeTable { bore_radius_mm: 5.5, outer_radius_mm: 6.5, ..tube.clone() };
        assert!((thin.collapse_below_ambient_kpa().unwrap() * 8.0 - 42.647).abs() < 1e-2);
        assert_eq!(TubeTable { modulus_mpa: None, ..tube }.collapse_below_ambient_kpa(), None);
    }
}
