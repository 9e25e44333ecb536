//! The standard atmosphere of ISO 2533:1975: the air's pressure over the altitude.

use libm::pow;

/// Pressure at sea level, in kPa (ISO 2533, table 1).
pub(super) const SEA_LEVEL_KPA: f64 = 101.325;

/// Altitudes that count, in m: inside the troposphere of ISO 2533, from below the lowest land to above the highest.
pub(super) const ALTITUDES_M: std::ops::RangeInclusive<f64> = -500.0..=9000.0;

/// Returns the air's pressure at a geometric altitude in m, in kPa.
///
/// ISO 2533:1975, section 2: p = p_0 (1 + beta H/T_0)^(-g/(beta R)) below 11 km, with beta = -6.5 K/km, T_0 = 288.15 K,
/// g = 9.80665 m/s² and R = 287.05287 J/(kg K). Its geopotential altitude is H = r h/(r + h) with r = 6356766 m.
pub(super) fn pressure_at_kpa(altitude_m: f64) -> f64 {
    const EARTH_M: f64 = 6_356_766.0;
    const TEMPERATURE_K: f64 = 288.15;
    const GRADIENT_K_M: f64 = -6.5e-3;
    const GRAVITY_M_S2: f64 = 9.806_65;
    const GAS_J_KG_K: f64 = 287.052_87;
    let geopotential_m = EARTH_M * altitude_m / (EARTH_M + altitude_m);
    let exponent = -GRAVITY_M_S2 / (GRADIENT_K_M * GAS_J_KG_K);
    SEA_LEVEL_KPA * pow(1.0 + GRADIENT_K_M * geopotential_m / TEMPERATURE_K, exponent)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pressures_are_those_of_the_tables() {
        // U.S. Standard Atmosphere 1976, table I (geometric altitude); its troposphere is that of ISO 2533.
        for (altitude_m, hpa) in [
            (0.0, 1013.25),
            (500.0, 954.61),
            (1000.0, 898.76),
            (2000.0, 795.01),
            (3000.0, 701.21),
            (5000.0, 540.48),
            (9000.0, 308.00),
        ] {
            let computed_hpa = 10.0 * pressure_at_kpa(altitude_m);
            assert!((computed_hpa - hpa).abs() < 0.011, "{computed_hpa} hPa at {altitude_m} m");
        }
        assert!((10.0 * pressure_at_kpa(-500.0) - 1074.78).abs() < 0.02);
    }
}
