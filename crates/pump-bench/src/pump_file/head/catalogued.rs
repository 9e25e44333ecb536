//! `[head] catalogue`: a bought head by its name in the catalogue.

use crate::heads::{bought_head, nearest_heads};
use crate::pump_file::PumpFile;
use crate::pump_file::range::{WrongValue, allow};

impl PumpFile {
    /// Fills in what the catalogue knows of the head and the file does not state: the volume of a revolution, the bore
    /// of the tube and the number of rollers. [`PumpFile::check_catalogued`] refuses a name that is unknown.
    pub(in crate::pump_file) fn fill_from_catalogue(&mut self) {
        let Some(head) = self.head.as_mut() else { return };
        let Some(row) = head.catalogue.as_deref().and_then(bought_head) else { return };
        if head.ml_per_rev.is_nan() {
            head.ml_per_rev = row.ml_per_rev;
        }
        head.tube_bore_mm = head.tube_bore_mm.or(row.bore_mm);
        if !self.rollers.is_given() {
            self.rollers.count = row.rollers.unwrap_or(self.rollers.count);
        }
    }

    /// Refuses a head that the catalogue does not have, a volume that is not the catalogue's, and a number of rollers
    /// that neither the file nor the catalogue states.
    pub(in crate::pump_file) fn check_catalogued(&self) -> Result<(), WrongValue> {
        let rollers = |allowed: &str| match self.rollers.is_given() {
            true => Ok(()),
            false => Err(WrongValue::missing("[rollers] count", allowed)),
        };
        let Some((head, name)) = self.head.as_ref().map(|head| (head, head.catalogue.as_ref())) else {
            return rollers("the number of rollers of the head");
        };
        let Some(name) = name else {
            let or = "1e-6 to 100000, or [head] catalogue = \"NAME\", a name of the catalogue";
            if head.ml_per_rev.is_nan() {
                return Err(WrongValue::missing("[head] ml_per_rev", or));
            }
            return rollers("the number of rollers of the head");
        };
        let Some(row) = bought_head(name) else {
            let nearest = nearest_heads(name).join(", ");
            let allowed = format!("a name of the catalogue; the nearest are {nearest}");
            return allow(false, "[head] catalogue", format_args!("`{name}`"), &allowed);
        };
        let allowed = format!("{} as {name} has in the catalogue; leave one of the two out", row.ml_per_rev);
        allow(head.ml_per_rev == row.ml_per_rev, "[head] ml_per_rev", head.ml_per_rev, &allowed)?;
        rollers(&format!("the rollers of your head, counted: the document of {name} does not state them"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A pump file whose head stands between the lines of `head`.
    fn file(head: &str) -> String {
        format!(
            "schema = \"pump/1\"\n\
             [pump]\nid = \"bought\"\nname = \"A bought head\"\ndefault_rate_ml_s = 0.2\n\
             {head}\n\
             [motor]\nsteps_per_rev = 3200\nmax_speed_rpm = 100.0\nmax_acceleration_rad_s2 = 100.0\n\
             [fluid]\nname = \"water\"\ntemperature_degc = 25.0\ndensity_kg_m3 = 997.0\n\
             [ambient]\npressure_kpa = 101.325\n"
        )
    }

    fn parsed(head: &str) -> PumpFile {
        PumpFile::parse(&file(head), "a file").unwrap()
    }

    fn refusal(head: &str) -> String {
        crate::report::with_sources(&PumpFile::parse(&file(head), "a file").unwrap_err())
    }

    #[test]
    fn a_name_of_the_catalogue_gives_volume_bore_and_rollers() {
        let by_name = parsed("[head]\ncatalogue = \"kamoer-kphm400-25\"");
        let head = by_name.head.as_ref().unwrap();
        assert_eq!((head.ml_per_rev, head.tube_bore_mm, by_name.rollers.count), (1.0, Some(4.8), 3));
        assert!((by_name.model().unwrap().revolution_ml() - 1.0).abs() < 1e-14);
        assert_eq!(PumpFile::parse(&by_name.to_toml(), "the same").unwrap(), by_name);
        // The same pump as one whose figures stand in the file, its uncertainty too.
        let by_figures = parsed("[head]\nml_per_rev = 1.0\ntube_bore_mm = 4.8\n[rollers]\ncount = 3");
        assert_eq!(by_name.uncertainty, by_figures.uncertainty);
        assert_eq!(by_name.model().unwrap(), by_figures.model().unwrap());
    }

    #[test]
    fn what_the_file_states_goes_before_the_catalogue() {
        let four = parsed("[head]\ncatalogue = \"kamoer-kphm400-25\"\n[rollers]\ncount = 4");
        assert_eq!(four.rollers.count, 4);
        let bore = parsed("[head]\ncatalogue = \"kamoer-kphm400-25\"\ntube_bore_mm = 4.7");
        assert_eq!(bore.head.unwrap().tube_bore_mm, Some(4.7));
        assert_eq!(
            refusal("[head]\ncatalogue = \"kamoer-kphm400-25\"\nml_per_rev = 0.9"),
            "pump file a file: [head] ml_per_rev is 0.9; allowed: 1 as kamoer-kphm400-25 has in the catalogue; \
             leave one of the two out"
        );
    }

    #[test]
    fn a_name_that_is_not_in_the_catalogue_is_answered_with_the_nearest() {
        assert_eq!(
            refusal("[head]\ncatalogue = \"masterflex-ls-61\"\n[rollers]\ncount = 3"),
            "pump file a file: [head] catalogue is `masterflex-ls-61`; allowed: a name of the \
             catalogue; the nearest are masterflex-ls-16, masterflex-ls-13, masterflex-ls-14"
        );
    }

    #[test]
    fn rollers_that_nobody_states_are_asked_for() {
        let said = refusal("[head]\ncatalogue = \"masterflex-ls-16\"");
        assert!(said.contains("[rollers] count is missing") && said.contains("masterflex-ls-16"), "{said}");
        let said = refusal("[head]\nml_per_rev = 0.8");
        assert!(said.contains("[rollers] count is missing"), "{said}");
        // A number that is given, even a wrong one, is never replaced.
        let said = refusal("[head]\ncatalogue = \"kamoer-kphm400-25\"\n[rollers]\ncount = 0");
        assert!(said.contains("number of rollers is 0"), "{said}");
        let said = refusal("[head]\ntube_bore_mm = 3.1\n[rollers]\ncount = 3");
        assert!(said.contains("[head] ml_per_rev is missing") && said.contains("catalogue = "), "{said}");
    }
}
