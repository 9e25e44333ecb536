//! Mixtures of glycerol and water.

use libm::{exp, pow, sin};

use core::f64::consts::PI;

use crate::error::{ModelError, Parameter, within};

use super::fluid::Fluid;

impl Fluid {
    /// Returns the properties of glycerol and water at 15 to 30 °C. `glycerol_part` is glycerol's part of the
    /// mass, 0 to 1.
    ///
    /// Density: Volk and Kähler, "Density model for aqueous glycerol solutions", Exp. Fluids 59:75, 2018,
    /// within 0.1 %. Viscosity: Cheng, "Formula for the viscosity of a glycerol-water mixture", Ind. Eng.
    /// Chem. Res. 47:3285, 2008, within 5 %. Bulk modulus: volumes of the parts with 3.94 GPa for glycerol
    /// (CRC Handbook), within a fifth. Vapour pressure: Raoult's law, which is a little too high, so limits
    /// that use it are on the safe side. Without water there is no vapour pressure.
    ///
    /// # Errors
    ///
    /// Refuses a part outside 0 to 1 and a temperature outside 15 to 30 °C.
    ///
    /// # Examples
    ///
    /// ```
    /// let half = pump_model::Fluid::glycerol_water(0.5, 20.0)?;
    /// assert!((half.density_kg_m3 - 1126.3).abs() < 0.5 && (half.viscosity_mpa_s / 6.0 - 1.0).abs() < 0.05);
    /// # Ok::<(), pump_model::ModelError>(())
    /// ```
    pub fn glycerol_water(glycerol_part: f64, temperature_degc: f64) -> Result<Self, ModelError> {
        within(Parameter::GlycerolPart, glycerol_part, 0.0..=1.0)?;
        within(Parameter::GlycerolTemperature, temperature_degc, 15.0..=30.0)?;
        let water = Self::water(temperature_degc)?;
        let (w, t) = (glycerol_part, temperature_degc);
        // Volk and Kähler: the volumes add except for a contraction.
        let glycerol_kg_m3 = 1273.3 - 0.6121 * t;
        let [glycerol_volume, water_volume] = [w / glycerol_kg_m3, (1.0 - w) / water.density_kg_m3];
        let contraction = 1.78e-6 * t * t - 1.82e-4 * t + 1.41e-2;
        // The sine of a half turn is 0 except for rounding, and a negative number has no such power.
        let shape = pow(sin(pow(w, 1.31) * PI).max(0.0), 0.81);
        let density_kg_m3 = (1.0 + contraction * shape) / (glycerol_volume + water_volume);
        const GLYCEROL_MPA: f64 = 1e4 / 2.54;
        let compressibility = (glycerol_volume / GLYCEROL_MPA + water_volume / water.bulk_modulus_mpa)
            / (glycerol_volume + water_volume);
        // Moles of both parts in 1 g of the mixture, with 92.094 and 18.015 g/mol.
        let [glycerol_moles, water_moles] = [w / 92.094, (1.0 - w) / 18.015];
        let raoult = water_moles / (glycerol_moles + water_moles);
        Ok(Self {
            density_kg_m3,
            viscosity_mpa_s: viscosity_mpa_s(w, t),
            bulk_modulus_mpa: 1.0 / compressibility,
            vapour_kpa: water.vapour_kpa.map(|kpa| raoult * kpa).filter(|kpa| *kpa > 0.0),
        })
    }
}

/// Viscosity of the mixture (Cheng 2008): equations 6 (mixture), 21 (water) and 22 (glycerol).
fn viscosity_mpa_s(part: f64, t: f64) -> f64 {
    let water = 1.790 * exp((-1230.0 - t) * t / (36_100.0 + 360.0 * t));
    let glycerol = 12_100.0 * exp((-1233.0 + t) * t / (9900.0 + 70.0 * t));
    let a = 0.705 - 0.0017 * t;
    let b = (4.9 + 0.036 * t) * pow(a, 2.5);
    let alpha = 1.0 - part + a * b * part * (1.0 - part) / (a * part + b * (1.0 - part));
    pow(water, alpha) * pow(glycerol, 1.0 - alpha)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mixtures_are_those_of_the_tables() {
        // Part, °C, kg/m³ (Bosart and Snoddy 1928, as in the CRC Handbook), mPa s (Segur and Oberstar 1951).
        for (part, t, density, viscosity) in [
            (0.1, 20.0, 1022.1, 1.31),
            (0.2, 20.0, 1046.9, 1.76),
            (0.5, 20.0, 1126.3, 6.00),
            (0.6, 20.0, 1153.8, 10.8),
            (0.8, 20.0, 1208.5, 60.1),
            (1.0, 20.0, 1261.1, 1410.0),
        ] {
            let fluid = Fluid::glycerol_water(part, t).unwrap();
            assert!((fluid.density_kg_m3 / density - 1.0).abs() < 1e-3, "{part}: {fluid:?}");
            assert!((fluid.viscosity_mpa_s / viscosity - 1.0).abs() < 0.05, "{part}: {fluid:?}");
        }
    }

    #[test]
    fn without_glycerol_it_is_water() {
        for t in [15.0, 25.0, 30.0] {
            let (none, water) = (Fluid::glycerol_water(0.0, t).unwrap(), Fluid::water(t).unwrap());
            assert!((none.density_kg_m3 / water.density_kg_m3 - 1.0).abs() < 1e-12);
            assert!((none.bulk_modulus_mpa / water.bulk_modulus_mpa - 1.0).abs() < 1e-12);
            assert!((none.viscosity_mpa_s / water.viscosity_mpa_s - 1.0).abs() < 0.02, "{none:?}");
            assert_eq!(none.vapour_kpa, water.vapour_kpa);
        }
    }

    #[test]
    fn parts_and_temperatures_beyond_the_formulas_are_refused() {
        for (part, t) in [(-0.1, 20.0), (1.1, 20.0), (50.0, 20.0), (f64::NAN, 20.0), (0.5, 14.0), (0.5, 31.0)]
        {
            assert!(
                matches!(Fluid::glycerol_water(part, t), Err(ModelError::OutOfRange { .. })),
                "{part} {t}"
            );
        }
        assert_eq!(Fluid::glycerol_water(1.0, 20.0).unwrap().vapour_kpa, None);
    }
}
