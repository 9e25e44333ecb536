//! `[fluid]`: what is pumped.

use pump_model::{Fluid, ModelError};
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// How far from the temperature of its density another fluid may be weighed, °C.
pub(crate) const SAME_TEMPERATURE_DEGC: f64 = 2.0;

/// The fluid that every pump file may be changed to.
const WATER: &str = "water";

/// What the model knows of a fluid of this name at a temperature, °C: water, ethanol, isopropanol, or glycerol with its part of
/// the mass, as `glycerol 50%`. None of another name.
fn known(name: &str, degc: f64) -> Option<Result<Fluid, ModelError>> {
    let name = name.trim().to_lowercase();
    match name.as_str() {
        WATER => Some(Fluid::water(degc)),
        "ethanol" => Some(Fluid::ethanol(degc)),
        "isopropanol" | "2-propanol" => Some(Fluid::isopropanol(degc)),
        _ => {
            let percent = name.strip_prefix("glycerol")?.trim().strip_suffix('%')?;
            let percent: f64 = percent.trim().parse().ok()?;
            Some(Fluid::glycerol_water(percent / 100.0, degc))
        }
    }
}

/// `[fluid]`
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FluidTable {
    /// For people; `water`, `ethanol`, `isopropanol` and `glycerol 50%` are also known to the model.
    pub name: String,
    /// Temperature at which the density holds, °C.
    pub temperature_degc: f64,
    /// Density, kg/m³: turns a mass into a volume.
    pub density_kg_m3: f64,
    /// Dynamic viscosity, mPa s, which a hose's R needs; that of a known fluid may be left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub viscosity_mpa_s: Option<f64>,
    /// Bulk modulus, MPa, which a hose's C needs; that of a known fluid may be left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bulk_modulus_mpa: Option<f64>,
    /// Vapour pressure, kPa absolute; that of a known fluid may be left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub vapour_kpa: Option<f64>,
}

/// A fluid or a temperature that is not known.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum FluidError {
    /// A fluid of which nothing is known.
    #[error(
        "nothing is known of the fluid `{name}`; known: water, ethanol, isopropanol, glycerol with its part of the mass as `glycerol 50%`, and the pump file's own, {own}; or write a pump file for it"
    )]
    Unknown {
        /// What was given.
        name: String,
        /// The pump file's fluid.
        own: String,
    },
    /// A fluid that is known at one temperature.
    #[error(
        "the density of {name} is known at {known_degc} °C alone (within 2 °C), not at {asked_degc} °C; write a pump file with its density there"
    )]
    Temperature {
        /// The fluid.
        name: String,
        /// What was asked, °C.
        asked_degc: f64,
        /// Where it is known, °C.
        known_degc: f64,
    },
    /// The fluid is not known at that temperature.
    #[error(transparent)]
    Model(#[from] ModelError),
}

impl FluidTable {
    /// The fluid of this name at this temperature, °C; what is not given stays as it is. The fluid of this table at its own
    /// temperature is the table; water has the density of any other, and other fluids that of the table within 2 °C.
    ///
    /// ```
    /// let own = pump_bench::built_in("three-roller").unwrap().fluid;
    /// assert_eq!(own.changed_to(Some("water"), None)?, own);
    /// assert!((own.changed_to(None, Some(40.0))?.density_kg_m3 - 992.22).abs() < 0.01);
    /// assert!(own.changed_to(Some("oil"), None).is_err());
    /// # Ok::<(), pump_bench::pump_file::FluidError>(())
    /// ```
    pub fn changed_to(&self, name: Option<&str>, temperature_degc: Option<f64>) -> Result<Self, FluidError> {
        let degc = temperature_degc.unwrap_or(self.temperature_degc);
        let same = name.is_none_or(|name| name.eq_ignore_ascii_case(&self.name));
        if same && degc == self.temperature_degc {
            return Ok(self.clone());
        }
        let asked = name.unwrap_or(&self.name);
        if let Some(fluid) = known(asked, degc) {
            return Ok(Self {
                name: asked.trim().to_lowercase(),
                temperature_degc: degc,
                density_kg_m3: fluid?.density_kg_m3,
                viscosity_mpa_s: None,
                bulk_modulus_mpa: None,
                vapour_kpa: None,
            });
        }
        if same && (degc - self.temperature_degc).abs() <= SAME_TEMPERATURE_DEGC {
            return Ok(Self { temperature_degc: degc, ..self.clone() });
        }
        let own = self.name.clone();
        Err(match name.filter(|_| !same) {
            Some(name) => FluidError::Unknown { name: name.to_owned(), own },
            None => {
                FluidError::Temperature { name: own, asked_degc: degc, known_degc: self.temperature_degc }
            }
        })
    }

    /// What is not known of it, though a hose needs it: table and key.
    pub(super) fn missing(&self) -> Option<&'static str> {
        let keys = [
            ("[fluid] viscosity_mpa_s", self.viscosity_mpa_s),
            ("[fluid] bulk_modulus_mpa", self.bulk_modulus_mpa),
        ];
        let unknown = keys.into_iter().find(|(_, value)| value.is_none());
        unknown.filter(|_| self.known().is_none()).map(|(key, _)| key)
    }

    /// What the model knows of it.
    fn known(&self) -> Option<Result<Fluid, ModelError>> {
        known(&self.name, self.temperature_degc)
    }

    /// The fluid for the model of a hose.
    pub fn fluid(&self) -> Result<Fluid, ModelError> {
        // Refused by name where it is not known and is asked for.
        let unknown = Fluid {
            density_kg_m3: self.density_kg_m3,
            viscosity_mpa_s: f64::NAN,
            bulk_modulus_mpa: f64::NAN,
            vapour_kpa: None,
        };
        let is_given = self.viscosity_mpa_s.is_some() && self.bulk_modulus_mpa.is_some();
        let known = self.known().filter(|_| !is_given).unwrap_or(Ok(unknown))?;
        let fluid = Fluid {
            density_kg_m3: self.density_kg_m3,
            viscosity_mpa_s: self.viscosity_mpa_s.unwrap_or(known.viscosity_mpa_s),
            bulk_modulus_mpa: self.bulk_modulus_mpa.unwrap_or(known.bulk_modulus_mpa),
            ..known
        };
        fluid.validate()?;
        Ok(fluid)
    }

    /// Vapour pressure, kPa absolute: as the file says, or what is known of the fluid at its temperature; none if it is not
    /// known.
    pub fn vapour_kpa(&self) -> Option<f64> {
        self.vapour_kpa.or_else(|| self.known()?.ok()?.vapour_kpa)
    }

    /// Density at a temperature, °C, if the model knows the fluid at its own: of water that of the tables, of others this
    /// table's, changed as much as that of the tables changes.
    pub(crate) fn density_at_kg_m3(&self, degc: f64) -> Option<Result<f64, ModelError>> {
        let (own, there) = (self.known()?.ok()?, known(&self.name, degc)?);
        let factor = if self.name.trim().eq_ignore_ascii_case(WATER) {
            1.0
        } else {
            self.density_kg_m3 / own.density_kg_m3
        };
        Some(there.map(|there| factor * there.density_kg_m3))
    }
}
