//! Surface tension of water.

use libm::pow;

use super::fluid::{Fluid, kelvin};
use crate::error::{ModelError, Parameter, within};

impl Fluid {
    /// Returns the surface tension of water against its vapour or air at 0 to 100 °C, in mN/m.
    ///
    /// sigma = B tau^mu (1 + b tau) with tau = 1 - T/T_c (IAPWS R1-76(2014)), within 0.5 %.
    ///
    /// # Errors
    ///
    /// Refuses a temperature outside 0 to 100 °C.
    ///
    /// # Examples
    ///
    /// ```
    /// assert!((pump_model::Fluid::water_surface_tension_mn_m(25.0)? - 71.97).abs() < 0.01);
    /// # Ok::<(), pump_model::ModelError>(())
    /// ```
    pub fn water_surface_tension_mn_m(temperature_degc: f64) -> Result<f64, ModelError> {
        const CRITICAL_K: f64 = 647.096;
        const B_MN_M: f64 = 235.8;
        const MU: f64 = 1.256;
        const B: f64 = -0.625;
        within(Parameter::WaterTemperature, temperature_degc, 0.0..=100.0)?;
        let tau = 1.0 - kelvin(temperature_degc) / CRITICAL_K;
        Ok(B_MN_M * pow(tau, MU) * (1.0 + B * tau))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_surface_tension_of_water_is_that_of_the_release() {
        // degC, mN/m: table 1 of IAPWS R1-76(2014).
        for (t, tension) in
            [(0.01, 75.65), (10.0, 74.22), (20.0, 72.74), (25.0, 71.97), (50.0, 67.94), (100.0, 58.91)]
        {
            let found = Fluid::water_surface_tension_mn_m(t).unwrap();
            assert!((found - tension).abs() < 0.006, "{t}: {found}");
        }
        for t in [-0.1, 100.1, f64::NAN] {
            assert!(Fluid::water_surface_tension_mn_m(t).is_err(), "{t}");
        }
    }
}
