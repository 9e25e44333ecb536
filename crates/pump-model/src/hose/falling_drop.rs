//! Volume of a drop that falls from a nozzle in air.

use core::f64::consts::PI;

use crate::error::{Allowed, ModelError, Parameter, within};

use super::fluid::series;

/// Standard acceleration of gravity, m/s² (ISO 80000-3).
const GRAVITY_M_S2: f64 = 9.806_65;

/// Largest r/V^(1/3) of the correction.
const MOST_RATIO: f64 = 1.2;

/// Returns the volume of a drop that falls slowly from a nozzle in air, mL.
///
/// Tate's law with the correction of Harkins and Brown: V = 2 pi r gamma psi(r/V^(1/3))/(rho g), r half the
/// bore, gamma the surface tension, rho the density. psi is the part of the ideal drop that falls; a residue
/// stays at the nozzle and is the start of the next drop (Harkins and Brown, J. Am. Chem. Soc. 41:499, 1919).
/// The polynomial is that of Lee, Chan and Pogaku (Lee, Ravindra and Chan, Chem. Eng. Commun. 195:889, 2008),
/// for r/V^(1/3) up to 1.2: a bore of 14 mm with water. Beyond, psi stays what it is there, which gives up to
/// a fifth more than Harkins and Brown measured.
///
/// ```
/// // Water at 25 °C from a bore of 2 mm.
/// let drop_ml = pump_model::falling_drop_ml(2.0, 71.97, 997.05)?;
/// assert!((drop_ml - 0.0335).abs() < 0.001);
/// # Ok::<(), pump_model::ModelError>(())
/// ```
///
/// # Errors
///
/// Refuses a bore in mm, a surface tension in mN/m or a density in kg/m³ that is not finite and positive.
pub fn falling_drop_ml(
    bore_mm: f64,
    surface_tension_mn_m: f64,
    density_kg_m3: f64,
) -> Result<f64, ModelError> {
    within(Parameter::NozzleBore, bore_mm, Allowed::POSITIVE)?;
    within(Parameter::SurfaceTension, surface_tension_mn_m, Allowed::POSITIVE)?;
    within(Parameter::Density, density_kg_m3, Allowed::POSITIVE)?;
    const MM2_PER_M2: f64 = 1e6;
    const N_PER_MN: f64 = 1e-3;
    const ML_PER_MM3: f64 = 1e-3;
    let radius_mm = 0.5 * bore_mm;
    let tension_mm2 =
        2.0 * PI * N_PER_MN * surface_tension_mn_m / (density_kg_m3 * GRAVITY_M_S2) * MM2_PER_M2;
    // With x = r/V^(1/3) the law is r² = tension_mm2 x³ psi(x), which rises with x.
    let square_mm2 = |x: f64| tension_mm2 * x * x * x * part_that_falls(x);
    let mm2 = radius_mm * radius_mm;
    if mm2 >= square_mm2(MOST_RATIO) {
        return Ok(ML_PER_MM3 * tension_mm2 * radius_mm * part_that_falls(MOST_RATIO));
    }
    let (mut low, mut high) = (0.0, MOST_RATIO);
    // 1.2/2^53 is the last bit.
    for _ in 0..53 {
        let middle = 0.5 * (low + high);
        if square_mm2(middle) < mm2 {
            low = middle;
        } else {
            high = middle;
        }
    }
    Ok(ML_PER_MM3 * tension_mm2 * radius_mm * part_that_falls(high))
}

/// Returns psi, the part of Tate's ideal drop that falls, at x = r/V^(1/3) up to 1.2: the polynomial of Lee,
/// Chan and Pogaku.
fn part_that_falls(x: f64) -> f64 {
    series([1.0, -0.9121, -2.109, 13.38, -27.29, 27.53, -13.58, 2.593], x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_correction_is_that_of_harkins_and_browns_table() {
        for (ratio, part) in [
            (0.30, 0.7256),
            (0.35, 0.7011),
            (0.40, 0.6828),
            (0.50, 0.6515),
            (0.60, 0.6250),
            (0.70, 0.6093),
            (0.80, 0.6000),
            (0.90, 0.5998),
            (1.00, 0.6098),
            (1.10, 0.6280),
            (1.20, 0.6535),
        ] {
            assert!((part_that_falls(ratio) / part - 1.0).abs() < 0.013, "{ratio}");
        }
    }

    #[test]
    fn drops_of_water_are_those_of_the_table() {
        // Tate's law solved over Harkins and Brown's table with straight lines between its entries.
        for (bore_mm, table_ml) in [
            (0.5, 0.01035),
            (1.0, 0.01917),
            (2.0, 0.03331),
            (3.0, 0.04702),
            (4.0, 0.05995),
            (6.0, 0.08491),
            (10.0, 0.13992),
        ] {
            let drop_ml = falling_drop_ml(bore_mm, 71.97, 997.05).unwrap();
            assert!((drop_ml / table_ml - 1.0).abs() < 0.02, "{bore_mm} mm: {drop_ml}");
        }
        // Ph. Eur. 2.1.1: 20 drops of water at 20 °C from a dropper of 3 mm weigh 1.000 g within 0.050 g. They
        // fall at one a second, which makes them a few percent larger than slow ones.
        let drop_ml = falling_drop_ml(3.0, 72.74, 998.2).unwrap();
        assert!((0.90..1.0).contains(&(drop_ml / 0.050)), "{drop_ml}");
    }

    #[test]
    fn a_wider_bore_always_has_the_larger_drop() {
        let mut last_ml = 0.0;
        for n in 1..400 {
            let drop_ml = falling_drop_ml(0.05 * f64::from(n), 22.0, 789.0).unwrap();
            assert!(drop_ml > last_ml, "{n}");
            last_ml = drop_ml;
        }
        for (bore_mm, tension, density) in [(0.0, 72.0, 997.0), (2.0, -1.0, 997.0), (2.0, 72.0, f64::NAN)] {
            assert!(falling_drop_ml(bore_mm, tension, density).is_err());
        }
    }
}
