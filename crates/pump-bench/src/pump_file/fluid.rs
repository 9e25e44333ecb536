//! `[fluid]`: the fluid that is pumped.

mod replaced;

use pump_model::{Fluid, ModelError};
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::range::{WrongValue, within, within_if_given};
use crate::notice::Notice;
use replaced::Replaced;
pub(crate) use replaced::THICK_MPA_S;

/// Largest temperature difference over which a fluid unknown to the model keeps its density, in °C.
pub(crate) const SAME_TEMPERATURE_DEGC: f64 = 2.0;

/// Name of the fluid to which every pump file may be changed.
const WATER: &str = "water";

/// Returns the model's fluid of this name at a temperature in °C, or `None` for an unknown name.
///
/// The model knows water, ethanol, isopropanol, and glycerol with its part of the mass, as in `glycerol 50%`.
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

/// The table `[fluid]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct FluidTable {
    /// Name of the fluid. The model knows `water`, `ethanol`, `isopropanol` and names like `glycerol 50%`.
    pub name: String,
    /// Temperature at which the density holds, in °C.
    pub temperature_degc: f64,
    /// Density, in kg/m³. It turns a mass into a volume.
    pub density_kg_m3: f64,
    /// Dynamic viscosity, in mPa s. The R of a hose needs it. A known fluid may leave it out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub viscosity_mpa_s: Option<f64>,
    /// Bulk modulus, in MPa. The C of a hose needs it. A known fluid may leave it out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bulk_modulus_mpa: Option<f64>,
    /// Vapour pressure, in kPa absolute. A known fluid may leave it out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub vapour_kpa: Option<f64>,
    /// Surface tension, in mN/m. The volume of a drop at the nozzle needs it. Without it that of water counts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub surface_tension_mn_m: Option<f64>,
    /// Fluid of the pump file that this one stands in for. `None` for the file's own.
    #[serde(skip)]
    pub(crate) replaced: Option<Replaced>,
}

/// A fluid or a temperature that is not known.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum FluidError {
    /// The fluid is not known.
    #[error(
        "nothing is known of the fluid `{name}`; known: water, ethanol, isopropanol, glycerol with its part \
         of the mass as `glycerol 50%`, and the pump file's own, {own}; or write a pump file for it"
    )]
    Unknown {
        /// Name that was given.
        name: String,
        /// Name of the pump file's fluid.
        own: String,
    },
    /// The fluid is known at another temperature alone.
    #[error(
        "the density of {name} is known at {known_degc} °C alone (within 2 °C), not at {asked_degc} °C; \
         write a pump file with its density there"
    )]
    Temperature {
        /// Name of the fluid.
        name: String,
        /// Temperature that was asked for, in °C.
        asked_degc: f64,
        /// Temperature at which the density is known, in °C.
        known_degc: f64,
    },
    /// The model does not know the fluid at the temperature.
    #[error(transparent)]
    Model(#[from] ModelError),
}

impl FluidTable {
    /// Returns the table for another fluid or another temperature in °C. A name or a temperature that is not
    /// given stays as it is.
    ///
    /// The table's own fluid at its own temperature returns the table itself. A fluid that the model knows
    /// takes the model's density. An unknown fluid keeps the density of the table within 2 °C.
    ///
    /// ```
    /// let own = pump_bench::built_in("three-roller").unwrap().fluid;
    /// assert_eq!(own.changed_to(Some("water"), None)?, own);
    /// assert!((own.changed_to(None, Some(40.0))?.density_kg_m3 - 992.22).abs() < 0.01);
    /// assert!(own.changed_to(Some("oil"), None).is_err());
    /// # Ok::<(), pump_bench::pump_file::FluidError>(())
    /// ```
    ///
    /// # Errors
    /// [`FluidError::Unknown`] for a fluid that is not known. [`FluidError::Temperature`] or
    /// [`FluidError::Model`] for a temperature at which the fluid is not known.
    pub fn changed_to(&self, name: Option<&str>, temperature_degc: Option<f64>) -> Result<Self, FluidError> {
        let degc = temperature_degc.unwrap_or(self.temperature_degc);
        let same = name.is_none_or(|name| name.eq_ignore_ascii_case(&self.name));
        if same && degc == self.temperature_degc {
            return Ok(self.clone());
        }
        let asked = name.unwrap_or(&self.name);
        let replaced = self.replaced.clone().or_else(|| Some(self.as_it_flows()));
        if let Some(fluid) = known(asked, degc) {
            return Ok(Self {
                name: asked.trim().to_lowercase(),
                temperature_degc: degc,
                density_kg_m3: fluid?.density_kg_m3,
                viscosity_mpa_s: None,
                bulk_modulus_mpa: None,
                vapour_kpa: None,
                surface_tension_mn_m: None,
                replaced,
            });
        }
        if same && (degc - self.temperature_degc).abs() <= SAME_TEMPERATURE_DEGC {
            return Ok(Self { temperature_degc: degc, replaced, ..self.clone() });
        }
        let own = self.name.clone();
        Err(match name.filter(|_| !same) {
            Some(name) => FluidError::Unknown { name: name.to_owned(), own },
            None => {
                FluidError::Temperature { name: own, asked_degc: degc, known_degc: self.temperature_degc }
            }
        })
    }

    /// Returns the fluid with its viscosity, as far as the table or the model knows it.
    fn as_it_flows(&self) -> Replaced {
        let of_model = || known(&self.name, self.temperature_degc)?.ok();
        let viscosity_mpa_s = self.viscosity_mpa_s.or_else(|| Some(of_model()?.viscosity_mpa_s));
        Replaced::new(&self.name, self.temperature_degc, viscosity_mpa_s)
    }

    /// Returns the warning of resistances that are given, of inlet and outlet, and do not follow this fluid. `None` for
    /// the pump file's own fluid.
    pub(super) fn resistance_warning(&self, are_given: [bool; 2]) -> Option<Notice> {
        self.replaced.as_ref()?.warning(&self.as_it_flows(), are_given)
    }

    /// Returns in words how this fluid fills a tube unlike the one of a name and a temperature in °C, with which
    /// `known_by` ends. `None` where both fill it alike.
    pub(crate) fn fills_unlike(&self, name: &str, degc: f64, known_by: &str) -> Option<String> {
        let is_own = self.name.eq_ignore_ascii_case(name)
            && (degc - self.temperature_degc).abs() <= SAME_TEMPERATURE_DEGC;
        let known = || Some(known(name, degc)?.ok()?.viscosity_mpa_s);
        let viscosity_mpa_s = self.viscosity_mpa_s.filter(|_| is_own).or_else(known);
        Replaced::new(name, degc, viscosity_mpa_s).fills_unlike(&self.as_it_flows(), known_by)
    }

    /// Refuses the first value outside its range. Where a line is a hose, refuses a fluid without the values
    /// it needs.
    pub(super) fn check(&self, has_hose: bool) -> Result<(), WrongValue> {
        within("[fluid] density_kg_m3", self.density_kg_m3, 10.0..=25_000.0)?;
        within("[fluid] temperature_degc", self.temperature_degc, -273.15..=1000.0)?;
        within_if_given("[fluid] vapour_kpa", self.vapour_kpa, 0.0..=1e4)
            .map_err(|wrong| wrong.hint("absolute"))?;
        within_if_given("[fluid] surface_tension_mn_m", self.surface_tension_mn_m, 1.0..=1000.0)
            .map_err(|wrong| wrong.hint("water has 72, ethanol 22"))?;
        match self.missing().filter(|_| has_hose) {
            Some(key) => Err(WrongValue::missing(
                key,
                "a number: a line from a hose needs it, and nothing is known of this fluid",
            )),
            None => Ok(()),
        }
    }

    /// Returns the table and key of a value that a hose needs and nobody knows.
    fn missing(&self) -> Option<&'static str> {
        let keys = [
            ("[fluid] viscosity_mpa_s", self.viscosity_mpa_s),
            ("[fluid] bulk_modulus_mpa", self.bulk_modulus_mpa),
        ];
        let unknown = keys.into_iter().find(|(_, value)| value.is_none());
        unknown.filter(|_| self.known().is_none()).map(|(key, _)| key)
    }

    /// Returns the model's fluid of this name, if the model knows it.
    fn known(&self) -> Option<Result<Fluid, ModelError>> {
        known(&self.name, self.temperature_degc)
    }

    /// Returns the fluid for the model of a hose.
    ///
    /// # Errors
    /// Returns the [`ModelError`] of a value that is out of range, or that is neither given nor known.
    pub(crate) fn fluid(&self) -> Result<Fluid, ModelError> {
        // Validation refuses a NaN by its name, if a hose needs it.
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

    /// Returns the vapour pressure in kPa absolute, from the file or else from the model. Returns `None` if
    /// neither knows it.
    pub(crate) fn vapour_kpa(&self) -> Option<f64> {
        self.vapour_kpa.or_else(|| self.known()?.ok()?.vapour_kpa)
    }

    /// Returns the surface tension in mN/m: that of the table, or else that of water at the table's temperature.
    ///
    /// Water's is the larger one: aqueous solutions of soluble organic liquids, and nearly all other liquids that
    /// are pumped, have less (ethanol 22, glycerol 63 mN/m at 20 °C). Brines have up to a tenth more, mercury has
    /// 487. Outside 0 to 100 °C the nearer end counts.
    pub(crate) fn surface_tension_mn_m(&self) -> Result<f64, ModelError> {
        let of_water = || Fluid::water_surface_tension_mn_m(self.temperature_degc.clamp(0.0, 100.0));
        self.surface_tension_mn_m.map_or_else(of_water, Ok)
    }

    /// Returns the density at a temperature in °C, if the model knows the fluid at the table's temperature.
    ///
    /// Water has the density of the model. Another fluid has the density of this table, scaled as the model's
    /// density changes between the two temperatures.
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
