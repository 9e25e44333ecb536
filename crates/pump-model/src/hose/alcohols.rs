//! Ethanol and isopropanol without water.

use libm::{exp, log, pow};

use core::ops::RangeInclusive;

use crate::error::{ModelError, Parameter, within};

use super::fluid::{Fluid, kelvin, series};

/// Published formulas of an alcohol's properties.
struct Alcohol {
    /// Temperature of the alcohol, as errors name it.
    parameter: Parameter,
    /// Temperatures at which all of the alcohol's formulas hold, °C.
    range_degc: RangeInclusive<f64>,
    /// Density in kg/m³ over °C, lowest order first: International Critical Tables, vol. 3, 1928.
    density: [f64; 4],
    /// ln(viscosity/Pa s) = C1 + C2/T + C3 ln T, T in K: Perry's Chemical Engineers' Handbook, 8th edition,
    /// table 2-313.
    viscosity: [f64; 3],
    /// log10(vapour pressure/Pa) = A - B/(T + C), T in K: Poling, Prausnitz, O'Connell, "The Properties of
    /// Gases and Liquids", 5th edition, appendix A.
    vapour: [f64; 3],
    /// Isothermal compressibility at one temperature, 1e-4/MPa: CRC Handbook of Chemistry and Physics,
    /// section 6. It changes by a sixth over the range, which is nothing beside the compliance of a soft
    /// wall.
    compressibility: f64,
}

const ETHANOL: Alcohol = Alcohol {
    parameter: Parameter::EthanolTemperature,
    range_degc: 5.0..=40.0,
    density: [806.25, -0.8461, 0.160e-3, -8.5e-6],
    viscosity: [7.875, 781.98, -3.0418],
    vapour: [10.336_75, 1648.22, -42.232],
    compressibility: 11.19,
};

const ISOPROPANOL: Alcohol = Alcohol {
    parameter: Parameter::IsopropanolTemperature,
    range_degc: 10.0..=40.0,
    density: [801.4, -0.809, -0.27e-3, 0.0],
    viscosity: [-8.8918, 2357.6, -0.913_76],
    vapour: [10.242_68, 1580.92, -53.54],
    compressibility: 13.32,
};

impl Alcohol {
    fn at(&self, temperature_degc: f64) -> Result<Fluid, ModelError> {
        within(self.parameter, temperature_degc, self.range_degc.clone())?;
        let t = kelvin(temperature_degc);
        let [c1, c2, c3] = self.viscosity;
        let [a, b, c] = self.vapour;
        Ok(Fluid {
            density_kg_m3: series(self.density, temperature_degc),
            viscosity_mpa_s: 1e3 * exp(c1 + c2 / t + c3 * log(t)),
            bulk_modulus_mpa: 1e4 / self.compressibility,
            vapour_kpa: Some(1e-3 * pow(10.0, a - b / (t + c))),
        })
    }
}

impl Fluid {
    /// Returns the properties of ethanol without water at 5 to 40 °C.
    ///
    /// Density is within 0.05 % (International Critical Tables), viscosity within 2 % (Perry), vapour
    /// pressure within 1 % (Poling, Prausnitz, O'Connell). The bulk modulus is that at 20 °C (CRC Handbook);
    /// it changes by a sixth over the range.
    ///
    /// # Errors
    ///
    /// Refuses a temperature outside 5 to 40 °C.
    ///
    /// # Examples
    ///
    /// ```
    /// let ethanol = pump_model::Fluid::ethanol(25.0)?;
    /// assert!((ethanol.density_kg_m3 - 785.1).abs() < 0.2);
    /// assert!((ethanol.viscosity_mpa_s - 1.074).abs() < 0.01);
    /// # Ok::<(), pump_model::ModelError>(())
    /// ```
    pub fn ethanol(temperature_degc: f64) -> Result<Self, ModelError> {
        ETHANOL.at(temperature_degc)
    }

    /// Returns the properties of isopropanol (2-propanol) without water at 10 to 40 °C.
    ///
    /// Sources and accuracy are those of [`Self::ethanol`]. The bulk modulus is that at 40 °C.
    ///
    /// # Errors
    ///
    /// Refuses a temperature outside 10 to 40 °C.
    pub fn isopropanol(temperature_degc: f64) -> Result<Self, ModelError> {
        ISOPROPANOL.at(temperature_degc)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn alcohols_are_those_of_the_tables() {
        // The columns are degC, kg/m³, mPa s and kPa. At 25 °C: CRC Handbook (viscosity), Riddick, Bunger,
        // Sakano, "Organic Solvents" (density and vapour pressure: 59.0 and 45.2 mmHg). At 20 and 40 °C: both
        // again, and OIML R 22 for ethanol's density.
        type Row = (f64, f64, Option<f64>, Option<f64>);
        let ethanol: [Row; 3] = [
            (20.0, 789.24, None, Some(5.95)),
            (25.0, 785.07, Some(1.074), Some(7.87)),
            (40.0, 772.1, None, Some(17.9)),
        ];
        let isopropanol: [Row; 2] = [(20.0, 785.4, None, Some(4.4)), (25.0, 781.2, Some(2.038), Some(6.02))];
        let check = |of: fn(f64) -> Result<Fluid, ModelError>, rows: &[Row]| {
            for &(degc, density, viscosity, vapour) in rows {
                let fluid = of(degc).unwrap();
                let near = |found: f64, table: Option<f64>, part: f64| {
                    assert!(
                        table.is_none_or(|table| (found / table - 1.0).abs() < part),
                        "{degc}: {fluid:?}"
                    );
                };
                near(fluid.density_kg_m3, Some(density), 6e-4);
                near(fluid.viscosity_mpa_s, viscosity, 0.02);
                near(fluid.vapour_kpa.unwrap(), vapour, 0.02);
                fluid.validate().unwrap();
            }
        };
        check(Fluid::ethanol, &ethanol);
        check(Fluid::isopropanol, &isopropanol);
    }

    #[test]
    fn temperatures_beyond_the_formulas_are_refused() {
        for degc in [4.9, 40.1, f64::NAN] {
            assert!(matches!(Fluid::ethanol(degc), Err(ModelError::OutOfRange { .. })), "{degc}");
            assert!(matches!(Fluid::isopropanol(degc), Err(ModelError::OutOfRange { .. })), "{degc}");
        }
        let cold = Fluid::isopropanol(9.0);
        let allowed = crate::error::Allowed::from(10.0..=40.0);
        assert!(
            matches!(cold, Err(ModelError::OutOfRange { allowed: found, .. }) if found == allowed),
            "{cold:?}"
        );
    }
}
