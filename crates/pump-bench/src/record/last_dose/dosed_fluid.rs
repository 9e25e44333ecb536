//! The fluid of a dose, by its name and temperature.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::pump_file::{FluidError, FluidTable};
use crate::record::ShortText;

/// Fluid of a dose, as the pump file or the person named it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct DosedFluid {
    /// Name of the fluid.
    pub name: ShortText,
    /// Temperature of the fluid, in °C.
    pub temperature_degc: f64,
}

impl DosedFluid {
    /// Returns the fluid of a table.
    pub fn of(table: &FluidTable) -> Self {
        Self { name: ShortText::new(&table.name), temperature_degc: table.temperature_degc }
    }

    /// Returns true if a table states this fluid at this temperature.
    pub fn is_of(&self, table: &FluidTable) -> bool {
        self.is_named(&table.name) && self.temperature_degc == table.temperature_degc
    }

    /// Returns the table of this fluid. A name and a temperature, in °C, that a person states win. `own` is the pump
    /// file's fluid.
    ///
    /// # Errors
    ///
    /// Errors of [`FluidTable::changed_to`].
    pub(crate) fn table(
        &self,
        own: &FluidTable,
        name: Option<&str>,
        temperature_degc: Option<f64>,
    ) -> Result<FluidTable, FluidError> {
        // A long name of the file is cut on record.
        let recorded = if self.is_named(&own.name) { own.name.as_str() } else { self.name.as_str() };
        let degc = temperature_degc.unwrap_or(self.temperature_degc);
        own.changed_to(Some(name.unwrap_or(recorded)), Some(degc))
    }

    fn is_named(&self, name: &str) -> bool {
        self.name.as_str().eq_ignore_ascii_case(ShortText::new(name).as_str())
    }
}

impl fmt::Display for DosedFluid {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(to, "{} at {} °C", self.name.as_str(), self.temperature_degc)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn own(name: &str) -> FluidTable {
        let water = crate::built_in("three-roller").unwrap().fluid;
        FluidTable { name: name.to_owned(), temperature_degc: 25.0, density_kg_m3: 1010.0, ..water }
    }

    #[test]
    fn a_dose_is_weighed_as_the_fluid_on_record_unless_a_person_says_another() {
        let media = own("media");
        let glycerol = media.changed_to(Some("glycerol 60%"), Some(22.0)).unwrap();
        let dosed = DosedFluid::of(&glycerol);
        assert!(dosed.is_of(&glycerol) && !dosed.is_of(&media));
        assert_eq!(dosed.table(&media, None, None).unwrap(), glycerol);
        assert_eq!(dosed.table(&media, Some("water"), None).unwrap().name, "water");
        assert_eq!(dosed.table(&media, None, Some(30.0)).unwrap().temperature_degc, 30.0);
        assert_eq!(DosedFluid::of(&media).table(&media, None, None).unwrap(), media);
        // The pump file has another fluid by now, and nobody knows the density of this one.
        let unknown = DosedFluid::of(&media).table(&own("broth"), None, None);
        assert!(matches!(unknown, Err(FluidError::Unknown { .. })), "{unknown:?}");
    }

    #[test]
    fn a_name_that_is_cut_on_record_is_still_the_files() {
        let long = own(&"a very long name of a fluid of the laboratory".repeat(2));
        assert_eq!(DosedFluid::of(&long).table(&long, None, None).unwrap(), long);
    }
}
