//! The volume of a mass that a scale shows: densities of fluid and air, and the factor Z of ISO 8655-6.

use libm::{exp, hypot};

use super::CalibrationError;
use crate::pump_file::{FluidTable, PumpFile, SAME_TEMPERATURE_DEGC};
use crate::units::Amount;

/// Density of the weights that scales are adjusted with, kg/m³ (OIML R 111-1:2004; ISO 8655-6:2002 uses it
/// too).
const WEIGHTS_KG_M3: f64 = 8000.0;

/// Relative humidity where nobody measured it, in percent: ISO 8655-6 asks for more than 50. From 30 to 80 %
/// Z changes by 4e-6.
const HUMIDITY_PERCENT: f64 = 50.0;

/// Standard uncertainty of the difference between two temperatures, in °C, each read to a degree.
pub(crate) const READ_DEGC: f64 = 0.8;

/// Standard uncertainty of the density of a fluid of which only the pump file's number is known, as a part of it. The
/// file's number has three or four digits.
const STATED_DENSITY: f64 = 1e-3;

/// Standard uncertainty of the density of air, as a part of it: pressure to 1 kPa and 1 °C of 100 kPa and 300 K.
/// Humidity adds 0.4 % (OIML R 111-1:2004, E.3, from 30 to 80 %).
const AIR: f64 = 0.012;

/// Density of air over that of water, at 20 °C and 101.3 kPa: the part of a reading that buoyancy makes.
const BUOYANCY: f64 = 1.2e-3;

/// Fluid that is weighed, and the air around the scale.
#[derive(Debug, Clone, PartialEq)]
pub struct Weighing<'a> {
    /// Fluid that is weighed.
    pub fluid: &'a FluidTable,
    /// Pressure of the air around the scale, in kPa absolute.
    pub ambient_kpa: f64,
}

impl<'a> Weighing<'a> {
    /// Returns the fluid and the air of a pump file.
    pub fn of(file: &'a PumpFile) -> Self {
        Self { fluid: &file.fluid, ambient_kpa: file.ambient.pressure_kpa }
    }

    /// Returns the volume, in mL, of an amount of fluid at the pump file's temperature. A mass is what a balance
    /// shows in this air, as in a calibration.
    ///
    /// ```
    /// use pump_bench::calibration::Weighing;
    /// use pump_bench::units::amount;
    /// let file = pump_bench::built_in("three-roller").unwrap();
    /// // Water of 25 °C at 85.7 kPa: Z is 1.0038 mL/g by the table of ISO 8655-6.
    /// assert!((Weighing::of(&file).amount_ml(amount("25g")?)? - 25.0 * 1.0038).abs() < 25.0 * 1e-4);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Errors of [`Self::volume_ml`].
    pub fn amount_ml(&self, amount: Amount) -> Result<f64, CalibrationError> {
        match amount {
            Amount::Volume(volume_ml) => Ok(volume_ml),
            Amount::Mass(mass_g) => self.volume_ml(mass_g, self.fluid.temperature_degc),
        }
    }

    /// Returns the standard uncertainty of the volume of a gram, as a part of it: density of the fluid at the pump
    /// file's temperature, and buoyancy.
    ///
    /// # Errors
    ///
    /// Errors of [`Self::volume_ml`].
    pub(crate) fn density_standard(&self) -> Result<f64, CalibrationError> {
        let degc = self.fluid.temperature_degc;
        let of_fluid = if self.fluid.density_at_kg_m3(degc).is_some() {
            (self.volume_ml(1.0, degc + READ_DEGC)? / self.volume_ml(1.0, degc)? - 1.0).abs()
        } else {
            STATED_DENSITY
        };
        Ok(hypot(of_fluid, AIR * BUOYANCY))
    }

    /// Returns the reading, in g, of a balance in this air for a volume in mL of fluid at the pump file's
    /// temperature. Returns `None` if the density of the fluid is not known.
    pub fn reading_g(&self, volume_ml: f64) -> Option<f64> {
        Some(volume_ml / self.volume_ml(1.0, self.fluid.temperature_degc).ok()?)
    }

    /// Returns the volume, in mL, of a mass in g that a scale shows for fluid at `temperature_degc`.
    ///
    /// Water has the density of its temperature. Other fluids that the model knows have the density of the
    /// pump file, changed by as much as theirs changes from the temperature there. Any other fluid is known
    /// at the temperature of the pump file alone, and must have that temperature within 2 °C.
    ///
    /// # Errors
    ///
    /// [`CalibrationError::FluidTemperature`] if the density of the fluid is not known at that temperature.
    /// [`CalibrationError::Model`] if the temperature is out of range for a fluid that the model knows.
    pub fn volume_ml(&self, mass_g: f64, temperature_degc: f64) -> Result<f64, CalibrationError> {
        let known_degc = self.fluid.temperature_degc;
        let is_there = (temperature_degc - known_degc).abs() <= SAME_TEMPERATURE_DEGC;
        let density_kg_m3 = match self.fluid.density_at_kg_m3(temperature_degc) {
            Some(Ok(density_kg_m3)) => density_kg_m3,
            _ if is_there => self.fluid.density_kg_m3,
            Some(Err(error)) => return Err(error.into()),
            None => {
                let fluid = self.fluid.name.clone();
                return Err(CalibrationError::FluidTemperature { fluid, temperature_degc, known_degc });
            }
        };
        Ok(mass_g * z_ml_g(density_kg_m3, air_kg_m3(temperature_degc, self.ambient_kpa)))
    }
}

/// Returns the density of air at 50 % relative humidity, in kg/m³: OIML R 111-1:2004, equation E.3-1, good to
/// 2e-4 of it near 20 °C.
pub(super) fn air_kg_m3(temperature_degc: f64, ambient_kpa: f64) -> f64 {
    let ambient_hpa = 10.0 * ambient_kpa;
    (0.348_48 * ambient_hpa - 0.009 * HUMIDITY_PERCENT * exp(0.061 * temperature_degc))
        / (273.15 + temperature_degc)
}

/// Returns Z, in mL/g: the volume of the fluid for each gram that the scale shows. Fluid and weights float in
/// air, so Z = (1 - rho_air/rho_weights)/(rho_fluid - rho_air) (ISO 8655-6:2002).
pub(super) fn z_ml_g(fluid_kg_m3: f64, air_kg_m3: f64) -> f64 {
    1e3 * (1.0 - air_kg_m3 / WEIGHTS_KG_M3) / (fluid_kg_m3 - air_kg_m3)
}

#[cfg(test)]
mod tests {
    use pump_model::Fluid;

    use super::*;

    #[test]
    fn z_is_that_of_the_standards_table() {
        // ISO 8655-6:2002, table of Z for distilled water, mL/mg times 1000: °C, kPa, Z.
        for (degc, kpa, z) in [
            (15.0, 101.3, 1.0020),
            (20.0, 101.3, 1.0029),
            (20.0, 80.0, 1.0026),
            (25.0, 101.3, 1.0040),
            (30.0, 101.3, 1.0054),
        ] {
            let computed = z_ml_g(Fluid::water(degc).unwrap().density_kg_m3, air_kg_m3(degc, kpa));
            assert!((computed - z).abs() < 0.6e-4, "{degc} °C, {kpa} kPa: {computed}");
        }
    }

    #[test]
    fn other_fluids_float_too_and_must_have_the_temperature_of_their_density() {
        let oil = fluid("silicone oil", 20.0, 960.0);
        let weighing = Weighing { fluid: &oil, ambient_kpa: 101.3 };
        let volume_ml = weighing.volume_ml(96.0, 21.0).unwrap();
        // Buoyancy: 1.2/960 less 1.2/8000.
        assert!((volume_ml - 100.0 * (1.0 + 1.195 / 960.0 - 1.195 / 8000.0)).abs() < 1e-3, "{volume_ml}");
        let error = weighing.volume_ml(96.0, 25.0).unwrap_err().to_string();
        assert!(error.contains("silicone oil") && error.contains("20 °C"), "{error}");
        let water = crate::catalogue::built_in("three-roller").unwrap();
        let weighing = Weighing::of(&water);
        assert!(weighing.volume_ml(10.0, 120.0).unwrap_err().to_string().contains("temperature of water"));
        assert!(weighing.volume_ml(10.0, f64::NAN).is_err());
        assert!((weighing.volume_ml(10.0, 25.0).unwrap() - 10.0384).abs() < 1e-3);
    }

    #[test]
    fn fluids_that_are_known_have_the_density_of_their_temperature() {
        // Densities at 20 and 30 °C: Riddick, Bunger, Sakano (ethanol), Bosart and Snoddy (glycerol).
        for (name, there, kg_m3) in [("ethanol", 789.24, 780.7), ("Glycerol 50 %", 1126.3, 1121.1)] {
            let table = fluid(name, 20.0, there);
            let volume_ml =
                Weighing { fluid: &table, ambient_kpa: 101.3 }.volume_ml(0.1 * kg_m3, 30.0).unwrap();
            let expected_ml = 0.1 * kg_m3 * z_ml_g(kg_m3, air_kg_m3(30.0, 101.3));
            assert!((volume_ml / expected_ml - 1.0).abs() < 6e-4, "{name}: {volume_ml} for {expected_ml}");
        }
        // Ethanol with some water in it stays what was measured.
        let technical = fluid("ethanol", 20.0, 810.0);
        let weighing = Weighing { fluid: &technical, ambient_kpa: 101.3 };
        let z = z_ml_g(810.0, air_kg_m3(20.0, 101.3));
        assert!((weighing.volume_ml(1.0, 20.0).unwrap() - z).abs() < 1e-12);
        let error = weighing.volume_ml(1.0, 60.0).unwrap_err().to_string();
        assert!(error.contains("temperature of ethanol") && error.contains("5 to 40"), "{error}");
        // Known at its own temperature alone.
        let hot = fluid("ethanol", 50.0, 763.0);
        let weighing = Weighing { fluid: &hot, ambient_kpa: 101.3 };
        assert!(weighing.volume_ml(1.0, 51.0).is_ok() && weighing.volume_ml(1.0, 20.0).is_err());
    }

    fn fluid(name: &str, temperature_degc: f64, density_kg_m3: f64) -> FluidTable {
        FluidTable {
            name: name.to_owned(),
            temperature_degc,
            density_kg_m3,
            viscosity_mpa_s: None,
            bulk_modulus_mpa: None,
            vapour_kpa: None,
            surface_tension_mn_m: None,
            replaced: None,
        }
    }
}
