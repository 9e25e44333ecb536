//! `[head]`: a bought head, of which the volume of a revolution stands in the place of its dimensions.

use serde::{Deserialize, Serialize};

use crate::heads::possible_ml;
use crate::numbers::significant;
use crate::pump_file::range::{WrongValue, allow, within, within_if_given};

/// The table `[head]`, in the place of `[tube]`, `[backplate]`, `[roller_volume]` and the rollers' dimensions.
///
/// ```
/// let head = pump_bench::pump_file::HeadTable::new(0.5);
/// assert_eq!((head.ml_per_rev, head.tube_bore_mm), (0.5, None));
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct HeadTable {
    /// Name of the head in the catalogue of [`crate::heads`]. It gives the volume of a revolution, and what else the
    /// file does not state.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub catalogue: Option<String>,
    /// Volume of a revolution of the pump head, in mL. NaN until the catalogue has given it.
    #[serde(default = "HeadTable::not_given")]
    pub ml_per_rev: f64,
    /// Diameter of the tube's bore, in mm. It tells how far heads of a kind differ. `None` if it is not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tube_bore_mm: Option<f64>,
}

impl HeadTable {
    /// Returns a head that delivers `ml_per_rev` a revolution, in mL.
    pub fn new(ml_per_rev: f64) -> Self {
        Self { catalogue: None, ml_per_rev, tube_bore_mm: None }
    }

    /// Returns the head of a name in the catalogue.
    ///
    /// ```
    /// use pump_bench::pump_file::HeadTable;
    ///
    /// let head = HeadTable::catalogued(pump_bench::heads::bought_head("masterflex-ls-16").unwrap());
    /// assert_eq!((head.ml_per_rev, head.tube_bore_mm), (0.8, Some(3.1)));
    /// ```
    pub fn catalogued(head: &crate::heads::BoughtHead) -> Self {
        Self { catalogue: Some(head.name.clone()), ml_per_rev: head.ml_per_rev, tube_bore_mm: head.bore_mm }
    }

    /// Returns the volume of a revolution that stands for none.
    fn not_given() -> f64 {
        f64::NAN
    }

    /// Refuses a volume or a bore outside its range, and a volume that no head delivers through such a bore.
    pub(in crate::pump_file) fn check(&self) -> Result<(), WrongValue> {
        within("[head] ml_per_rev", self.ml_per_rev, 1e-6..=1e5)?;
        within_if_given("[head] tube_bore_mm", self.tube_bore_mm, 0.01..=200.0)?;
        let Some(bore_mm) = self.tube_bore_mm else { return Ok(()) };
        let (least_ml, most_ml) = possible_ml(bore_mm);
        let allowed = format!(
            "{} to {} for this bore: less leaves no room for the shaft beside the tube, and more takes a rotor of more \
             than 3 m",
            significant(least_ml, 3),
            significant(most_ml, 3)
        );
        let value = format_args!("{} beside tube_bore_mm = {bore_mm}", self.ml_per_rev);
        allow((least_ml..=most_ml).contains(&self.ml_per_rev), "[head] ml_per_rev", value, &allowed)
    }
}

#[cfg(test)]
mod tests {
    use crate::pump_file::{LineTable, PumpFile};

    /// A pump file of which nothing is known but what a data sheet says.
    const BOUGHT: &str = r#"
        schema = "pump/1"
        [pump]
        id = "bought"
        name = "A bought head"
        default_rate_ml_s = 0.2
        [head]
        ml_per_rev = 0.5
        [rollers]
        count = 4
        [motor]
        steps_per_rev = 3200
        max_speed_rpm = 100.0
        max_acceleration_rad_s2 = 100.0
        [fluid]
        name = "water"
        temperature_degc = 25.0
        density_kg_m3 = 997.0
        [ambient]
        pressure_kpa = 101.325
    "#;

    fn refusal(text: &str) -> String {
        crate::report::with_sources(&PumpFile::parse(text, "a file").unwrap_err())
    }

    #[test]
    fn a_head_known_by_its_volume_alone_is_read_written_and_modelled() {
        let file = PumpFile::parse(BOUGHT, "a file").unwrap();
        assert_eq!(PumpFile::parse(&file.to_toml(), "the same").unwrap(), file);
        let pump = file.model().unwrap();
        assert!((pump.revolution_ml() - 0.5).abs() < 1e-14 && pump.geometry().rollers == 4);
        assert!(!pump.geometry().is_known());
        let with_life = BOUGHT.replace("[motor]", "[tube]\nlife_ml = 5000.0\n[motor]");
        assert_eq!(PumpFile::parse(&with_life, "a file").unwrap().tube.life_ml, Some(5000.0));
    }

    #[test]
    fn a_head_that_is_given_twice_is_refused_in_one_message() {
        for (added, key) in [
            ("[tube]\nbore_radius_mm = 1.0\nouter_radius_mm = 2.0\n", "[tube] bore_radius_mm"),
            ("[tube]\nmodulus_mpa = 3.5\npoisson_ratio = 0.49\n", "[tube] modulus_mpa"),
            ("[backplate]\nradius_mm = 20.0\ncontact_angle_deg = 30.0\n", "[backplate]"),
            ("[roller_volume]\nsource = \"drawing\"\n", "[roller_volume]"),
        ] {
            let said = refusal(&BOUGHT.replace("[motor]", &format!("{added}[motor]")));
            assert_eq!(
                said,
                format!(
                    "pump file a file: [head] ml_per_rev is 0.5 beside {key}; allowed: either [head] ml_per_rev \
                     with [rollers] count, or [tube], [backplate], [roller_volume], and [rollers] radius_mm and \
                     offset_mm"
                )
            );
        }
        let said = refusal(&BOUGHT.replace("count = 4", "count = 4\nradius_mm = 5.0"));
        assert!(said.contains("0.5 beside [rollers] radius_mm"), "{said}");
    }

    #[test]
    fn a_head_that_is_not_given_is_refused_with_both_ways() {
        let said = refusal(&BOUGHT.replace("[head]\n        ml_per_rev = 0.5", ""));
        assert!(
            said.contains("[tube] bore_radius_mm is missing") && said.ends_with("or [head] ml_per_rev"),
            "{said}"
        );
        for ml in ["0.0", "-1.0", "nan", "inf", "1e9"] {
            let said = refusal(&BOUGHT.replace("ml_per_rev = 0.5", &format!("ml_per_rev = {ml}")));
            assert!(said.contains("[head] ml_per_rev is"), "{said}");
        }
        let said = refusal(&BOUGHT.replace("count = 4", "count = 0"));
        assert!(said.contains("number of rollers is 0"), "{said}");
    }

    #[test]
    fn a_volume_that_no_head_delivers_through_its_bore_is_refused_with_the_range() {
        let with = |ml: &str, bore: &str| {
            let head = format!("ml_per_rev = {ml}\ntube_bore_mm = {bore}");
            BOUGHT
                .replace("ml_per_rev = 0.5", &head)
                .replace("default_rate_ml_s = 0.2", "default_rate_ml_s = 0.1")
        };
        // pi²/12 1.6³ = 3.37 mm³, and pi/4 1.6² 10 m = 20.1 mL.
        let said = refusal(&with("500.0", "1.6"));
        assert!(
            said.contains(
                "[head] ml_per_rev is 500 beside tube_bore_mm = 1.6; allowed: 0.00337 to 20.1 for this bore"
            ),
            "{said}"
        );
        // pi²/12 30³ = 22.2 mL.
        let said = refusal(&with("0.5", "30.0"));
        assert!(said.contains("allowed: 22.2 to 7069 for this bore"), "{said}");
        assert!(PumpFile::parse(&with("0.3", "1.6"), "a file").is_ok());
    }

    #[test]
    fn built_in_pumps_still_need_all_of_their_tables() {
        let whole = crate::catalogue::built_in("three-roller").unwrap();
        let without = |change: fn(&mut PumpFile)| {
            let mut file = whole.clone();
            change(&mut file);
            refusal(&file.to_toml())
        };
        assert!(without(|file| file.backplate = None).contains("[backplate] is missing"));
        assert!(
            without(|file| file.tube.outer_radius_mm = None).contains("[tube] outer_radius_mm is missing")
        );
        assert!(without(|file| file.inlet = LineTable::UNKNOWN).contains("[inlet] is missing"));
        assert!(
            without(|file| file.uncertainty.roller_volume_ml = None).contains("roller_volume_ml is missing")
        );
    }
}
