//! Another fluid than the pump file's, and the lines whose resistance does not follow it.

use crate::notice::{Notice, Remedy};

/// Part by which a viscosity may differ before the resistance of the file's own fluid is warned of.
const ALIKE: f64 = 0.1;

/// Viscosity from which on a fluid is thicker than the water of published flows, in mPa s: twice that of water at 20
/// °C.
pub(crate) const THICK_MPA_S: f64 = 2.0;

/// Factor by which a viscosity may differ before a volume that was weighed with one fluid is doubtful for the other.
const FILLS_ALIKE: f64 = 2.0;

/// A fluid as it flows: the one that a pump file states, where another one stands in for it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Replaced {
    name: String,
    temperature_degc: f64,
    viscosity_mpa_s: Option<f64>,
}

impl Replaced {
    /// Returns a fluid of this name, temperature and viscosity, as far as the latter is known.
    pub(super) fn new(name: &str, temperature_degc: f64, viscosity_mpa_s: Option<f64>) -> Self {
        Self { name: name.to_owned(), temperature_degc, viscosity_mpa_s }
    }

    /// Returns the fluid in words, as `water at 25 °C`.
    fn told(&self) -> String {
        format!("{} at {} °C", self.name, self.temperature_degc)
    }

    /// Returns true if the fluid flows as `other` does. A viscosity that nobody knows counts as another one, unless the
    /// fluid has kept its name.
    fn flows_as(&self, other: &Self) -> bool {
        match self.viscosity_mpa_s.zip(other.viscosity_mpa_s) {
            Some((own, other)) => (other / own - 1.0).abs() <= ALIKE,
            None => self.name.eq_ignore_ascii_case(&other.name),
        }
    }

    /// Returns in words how `now` fills a tube unlike this fluid, with which `known` begins. `None`
    /// where both fill it alike.
    pub(super) fn fills_unlike(&self, now: &Self, known: &str) -> Option<String> {
        let of_them = format!("{known} {}, and this is {}", self.told(), now.told());
        let fills = "of two fluids the thicker fills the tube less, and nobody has weighed by how much";
        match self.viscosity_mpa_s.zip(now.viscosity_mpa_s) {
            Some((own, other)) if own.max(other) <= THICK_MPA_S => None,
            Some((own, other)) if (1.0 / FILLS_ALIKE..=FILLS_ALIKE).contains(&(other / own)) => None,
            Some((own, other)) => {
                Some(format!("{of_them} of {:.2} times the viscosity: {fills}", other / own))
            }
            None if self.name.eq_ignore_ascii_case(&now.name) => None,
            None => Some(format!("{of_them} of a viscosity that nobody knows: {fills}")),
        }
    }

    /// Returns the warning that the resistances that are given, of inlet and outlet, stay those of this fluid and not
    /// of `now`. `None` where both flow alike or no resistance is given.
    pub(super) fn warning(&self, now: &Self, are_given: [bool; 2]) -> Option<Notice> {
        if self.flows_as(now) {
            return None;
        }
        let lines = match are_given {
            [true, true] => "the resistances of [inlet] and [outlet] are fixed numbers",
            [true, false] => "the resistance of [inlet] is a fixed number",
            [false, true] => "the resistance of [outlet] is a fixed number",
            [false, false] => return None,
        };
        let thicker = match self.viscosity_mpa_s.zip(now.viscosity_mpa_s) {
            Some((own, other)) => format!("has {:.2} times the viscosity", other / own),
            None => "has another viscosity".to_owned(),
        };
        let text = format!(
            "{lines} in the pump file, so pressures, settling and back flow stay those of {}; {} {thicker}",
            self.told(),
            now.told()
        );
        Some(Notice::from(text).with_remedy(Remedy::DescribeHose))
    }
}

#[cfg(test)]
mod tests {
    use crate::catalogue::built_in;
    use crate::pump_file::{HoseTable, LineTable, PumpFile};

    fn with(file: &PumpFile, name: Option<&str>, degc: Option<f64>) -> PumpFile {
        PumpFile { fluid: file.fluid.changed_to(name, degc).unwrap(), ..file.clone() }
    }

    fn hose() -> HoseTable {
        HoseTable {
            bore_radius_mm: 3.0,
            outer_radius_mm: 5.0,
            length_mm: 1000.0,
            modulus_mpa: 3.5,
            poisson_ratio: 0.5,
            minor_loss: 0.0,
            resistance_at_ml_s: Some(0.5),
        }
    }

    #[test]
    fn a_fixed_resistance_is_said_to_stay_that_of_the_files_own_fluid() {
        let file = built_in("three-roller").unwrap();
        let warning = with(&file, Some("glycerol 50%"), Some(20.0)).resistance_warning().unwrap();
        // Segur and Oberstar: 6.00 mPa s at 20 °C; IAPWS: 0.890 mPa s for water at 25 °C. Cheng's formula is within 5
        // %.
        let times: f64 =
            warning.text().split("has ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
        assert!((times / (6.00 / 0.890) - 1.0).abs() < 0.05, "{warning}");
        assert!(warning.text().starts_with("the resistances of [inlet] and [outlet]"), "{warning}");
        // IAPWS: water has 1.0016 mPa s at 20 °C and 0.8900 at 25 °C, 12.5 % apart.
        assert!(with(&file, None, Some(20.0)).resistance_warning().is_some());
        assert_eq!(with(&file, None, Some(24.0)).resistance_warning(), None);
        let back = with(&with(&file, Some("ethanol"), None), Some("water"), Some(25.0));
        assert_eq!(back.resistance_warning(), None, "it is the file's own again");
    }

    #[test]
    fn a_hose_follows_the_fluid_and_needs_no_warning() {
        let mut file = built_in("three-roller").unwrap();
        file.outlet = LineTable::of_hose_with_lift(0.0, hose()).into();
        let thick = with(&file, Some("glycerol 50%"), Some(20.0));
        let warning = thick.resistance_warning().unwrap();
        assert!(warning.text().starts_with("the resistance of [inlet] is"), "{warning}");
        // Hagen and Poiseuille, Re < 20: the resistance goes as the viscosity, the inertance as the density.
        let outlet = |file: &PumpFile| *file.model().unwrap().outlet();
        let [water, glycerol] = [outlet(&with(&file, None, Some(20.0))), outlet(&thick)];
        let ratio = glycerol.resistance_kpa_s_ml / water.resistance_kpa_s_ml;
        assert!((ratio / (6.00 / 1.0016) - 1.0).abs() < 0.05, "{ratio}");
        let ratio = glycerol.inertance_kpa_s2_ml / water.inertance_kpa_s2_ml;
        assert!((ratio / (1126.3 / 998.2) - 1.0).abs() < 1e-3, "{ratio}");
        file.inlet = LineTable::of_hose_with_lift(0.0, hose());
        assert_eq!(with(&file, Some("glycerol 50%"), Some(20.0)).resistance_warning(), None);
    }

    #[test]
    fn a_volume_that_was_weighed_with_a_fluid_far_thicker_or_thinner_is_doubtful() {
        let file = built_in("three-roller").unwrap();
        let said = |dosed: Option<&str>, weighed: &str, degc: f64| {
            with(&file, dosed, Some(25.0)).fluid.fills_unlike(weighed, degc, "calibration 1 was weighed with")
        };
        // Glycerol of 50 % at 25 °C: 5.03 mPa s by Cheng (2008), and water 0.89.
        let thick = said(Some("glycerol 50%"), "water", 25.0).unwrap();
        assert!(thick.starts_with("calibration 1 was weighed with water at 25 °C, and this is"), "{thick}");
        let times: f64 = thick.split(" of ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
        assert!((times - 5.6).abs() < 0.2, "{thick}");
        assert!(said(None, "glycerol 50%", 25.0).is_some() && said(None, "syrup", 25.0).is_some());
        assert_eq!(said(None, "water", 80.0), None, "hot water fills a tube as cold water does");
        assert_eq!(said(Some("ethanol"), "water", 25.0), None);
        assert_eq!(said(Some("glycerol 50%"), "Glycerol 50%", 20.0), None);
    }
}
