//! `[fluid]`: what is pumped.

use pump_model::{Fluid, ModelError};
use serde::{Deserialize, Serialize};

/// `[fluid]`
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FluidTable {
    /// For people; `water` is also known to the model.
    pub name: String,
    /// Temperature at which the density holds, °C.
    pub temperature_degc: f64,
    /// Density, kg/m³: turns a mass into a volume.
    pub density_kg_m3: f64,
    /// Dynamic viscosity, mPa s, which a hose's R needs; water's is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub viscosity_mpa_s: Option<f64>,
    /// Bulk modulus, MPa, which a hose's C needs; water's is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bulk_modulus_mpa: Option<f64>,
    /// Vapour pressure, kPa absolute; that of water from 0 to 100 °C is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub vapour_kpa: Option<f64>,
}

impl FluidTable {
    /// What is not known of it, though a hose needs it: table and key.
    pub(super) fn missing(&self) -> Option<&'static str> {
        let keys = [
            ("[fluid] viscosity_mpa_s", self.viscosity_mpa_s),
            ("[fluid] bulk_modulus_mpa", self.bulk_modulus_mpa),
        ];
        let unknown = keys.into_iter().find(|(_, value)| value.is_none());
        unknown.filter(|_| !self.is_water()).map(|(key, _)| key)
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
        let known = if self.is_water() { Fluid::water(self.temperature_degc)? } else { unknown };
        let fluid = Fluid {
            density_kg_m3: self.density_kg_m3,
            viscosity_mpa_s: self.viscosity_mpa_s.unwrap_or(known.viscosity_mpa_s),
            bulk_modulus_mpa: self.bulk_modulus_mpa.unwrap_or(known.bulk_modulus_mpa),
            ..known
        };
        fluid.validate()?;
        Ok(fluid)
    }

    /// Vapour pressure, kPa absolute: as the file says, or water's at its temperature; none if it is not known.
    pub fn vapour_kpa(&self) -> Option<f64> {
        let of_water = || Fluid::water(self.temperature_degc).ok().filter(|_| self.is_water())?.vapour_kpa;
        self.vapour_kpa.or_else(of_water)
    }

    pub(crate) fn is_water(&self) -> bool {
        self.name.eq_ignore_ascii_case("water")
    }
}
