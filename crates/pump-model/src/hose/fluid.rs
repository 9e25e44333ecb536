//! The fluid that is pumped: density, viscosity, bulk modulus, vapour pressure.

use libm::{exp, pow};

use crate::error::{Allowed, ModelError, Parameter, within};

/// Properties of a fluid at one temperature, at about atmospheric pressure.
///
/// ```
/// let water = pump_model::Fluid::water(25.0)?;
/// assert!((water.density_kg_m3 - 997.05).abs() < 0.02 && (water.viscosity_mpa_s - 0.89).abs() < 2e-3);
/// // A fluid from its data sheet.
/// let oil = pump_model::Fluid {
///     density_kg_m3: 870.0, viscosity_mpa_s: 50.0, bulk_modulus_mpa: 1500.0, vapour_kpa: None,
/// };
/// oil.validate()?;
/// # Ok::<(), pump_model::ModelError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Fluid {
    /// Density rho, kg/m³.
    pub density_kg_m3: f64,
    /// Dynamic viscosity mu, mPa s.
    pub viscosity_mpa_s: f64,
    /// Isothermal bulk modulus K, MPa.
    pub bulk_modulus_mpa: f64,
    /// Vapour pressure, kPa absolute; none if it is not known.
    pub vapour_kpa: Option<f64>,
}

impl Fluid {
    /// Returns the properties of water at 0 to 100 °C.
    ///
    /// Density and compressibility: Kell, J. Chem. Eng. Data 20:97, 1975, 0.01 kg/m³ and 0.2 % from later
    /// formulations. Viscosity: IAPWS SR6-08 (0.1 MPa), within 1 %. Vapour pressure: IAPWS SR1-86, within 0.1
    /// %.
    ///
    /// # Errors
    ///
    /// Refuses a temperature outside 0 to 100 °C.
    ///
    /// # Examples
    ///
    /// ```
    /// let water = pump_model::Fluid::water(25.0)?;
    /// assert!((water.density_kg_m3 - 997.05).abs() < 0.01 && (water.viscosity_mpa_s - 0.890).abs() < 1e-3);
    /// # Ok::<(), pump_model::ModelError>(())
    /// ```
    pub fn water(temperature_degc: f64) -> Result<Self, ModelError> {
        within(Parameter::WaterTemperature, temperature_degc, 0.0..=100.0)?;
        Ok(Self {
            density_kg_m3: water_density_kg_m3(temperature_degc),
            viscosity_mpa_s: water_viscosity_mpa_s(temperature_degc),
            bulk_modulus_mpa: water_bulk_modulus_mpa(temperature_degc),
            vapour_kpa: Some(water_vapour_kpa(temperature_degc)),
        })
    }

    /// Checks the properties of the fluid.
    ///
    /// # Errors
    ///
    /// Refuses properties that are not finite and positive.
    pub fn validate(&self) -> Result<(), ModelError> {
        within(Parameter::Density, self.density_kg_m3, Allowed::POSITIVE)?;
        within(Parameter::Viscosity, self.viscosity_mpa_s, Allowed::POSITIVE)?;
        within(Parameter::BulkModulus, self.bulk_modulus_mpa, Allowed::POSITIVE)?;
        self.vapour_kpa.map_or(Ok(()), |kpa| within(Parameter::VapourPressure, kpa, Allowed::POSITIVE))
    }
}

/// Returns the value of a polynomial at x.
pub(crate) fn series<const N: usize>(lowest_first: [f64; N], x: f64) -> f64 {
    lowest_first.iter().rev().fold(0.0, |sum, c| sum * x + c)
}

/// Density of air-free water at 101.325 kPa (Kell 1975).
fn water_density_kg_m3(t: f64) -> f64 {
    const NUMERATOR: [f64; 6] =
        [999.839_52, 16.945_176, -7.987_040_1e-3, -46.170_461e-6, 105.563_02e-9, -280.542_53e-12];
    series(NUMERATOR, t) / (1.0 + 16.879_850e-3 * t)
}

/// Bulk modulus of water (Kell 1975, whose isothermal compressibility is in 1e-6/bar).
fn water_bulk_modulus_mpa(t: f64) -> f64 {
    const NUMERATOR: [f64; 6] =
        [50.884_96, 0.616_381_3, 1.459_187e-3, 20.084_38e-6, -58.477_27e-9, 410.411_0e-12];
    const MPA_PER_BAR: f64 = 0.1;
    1e6 * MPA_PER_BAR * (1.0 + 19.673_48e-3 * t) / series(NUMERATOR, t)
}

/// Viscosity of water (IAPWS SR6-08): the sum of a (T/300 K)^b in uPa s.
fn water_viscosity_mpa_s(t: f64) -> f64 {
    const TERMS: [(f64, f64); 4] = [(280.68, -1.9), (511.45, -7.7), (61.131, -19.6), (0.459_03, -40.0)];
    let reduced = kelvin(t) / 300.0;
    1e-3 * TERMS.iter().map(|(a, b)| a * pow(reduced, *b)).sum::<f64>()
}

/// Vapour pressure of water (IAPWS SR1-86): ln(p/p_c) = T_c/T times the sum of a (1 - T/T_c)^b.
fn water_vapour_kpa(t: f64) -> f64 {
    const CRITICAL_K: f64 = 647.096;
    const CRITICAL_KPA: f64 = 22_064.0;
    const TERMS: [(f64, f64); 6] = [
        (-7.859_517_83, 1.0),
        (1.844_082_59, 1.5),
        (-11.786_649_7, 3.0),
        (22.680_741_1, 3.5),
        (-15.961_871_9, 4.0),
        (1.801_225_02, 7.5),
    ];
    let below = 1.0 - kelvin(t) / CRITICAL_K;
    let sum: f64 = TERMS.iter().map(|(a, b)| a * pow(below, *b)).sum();
    CRITICAL_KPA * exp(CRITICAL_K / kelvin(t) * sum)
}

pub(crate) fn kelvin(degc: f64) -> f64 {
    degc + 273.15
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn water_is_that_of_the_tables() {
        // degC, kg/m³ (CRC Handbook), mPa s (IAPWS R12-08), kPa (IAPWS-95, saturation).
        for (t, density, viscosity, vapour) in [
            (0.01, 999.84, 1.7911, 0.611_66),
            (20.0, 998.21, 1.0016, 2.3393),
            (25.0, 997.05, 0.8900, 3.1699),
            (40.0, 992.22, 0.6527, 7.3849),
            (60.0, 983.20, 0.4660, 19.946),
            (80.0, 971.79, 0.3540, 47.414),
            (100.0, 958.36, 0.2816, 101.42),
        ] {
            let water = Fluid::water(t).unwrap();
            assert!((water.density_kg_m3 - density).abs() < 0.02, "{t}: {water:?}");
            assert!((water.viscosity_mpa_s / viscosity - 1.0).abs() < 2e-3, "{t}: {water:?}");
            assert!((water.vapour_kpa.unwrap() / vapour - 1.0).abs() < 1e-3, "{t}: {water:?}");
        }
        // Kell's table: 45.89e-6 and 45.24e-6 per bar.
        for (t, per_bar) in [(20.0, 45.89e-6), (25.0, 45.24e-6)] {
            assert!((Fluid::water(t).unwrap().bulk_modulus_mpa * per_bar * 10.0 - 1.0).abs() < 5e-4, "{t}");
        }
        for t in [-0.1, 100.1, f64::NAN] {
            assert!(matches!(Fluid::water(t), Err(ModelError::OutOfRange { .. })), "{t}");
        }
    }
}
