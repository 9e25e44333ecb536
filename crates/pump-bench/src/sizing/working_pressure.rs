//! The working pressure that a maker of tubing suggests, by wall and bore.

/// Largest suggested working pressure of peristaltic pump tubing at 23 °C in kPa above the air, over wall/bore:
/// Saint-Gobain Performance Plastics, "Pressure Ratings for Peristaltic Pump Tubings" (a fifth of the burst pressure).
/// The table's eleven sizes with one ratio agree, so that the ratio tells it.
const SUGGESTED: [(f64, f64); 7] = [
    (0.125, 96.0),
    (0.1875, 131.0),
    (0.2, 145.0),
    (0.25, 172.0),
    (1.0 / 3.0, 214.0),
    (0.5, 296.0),
    (1.0, 482.0),
];

/// Returns the working pressure in kPa above the air that is suggested for a tube, interpolated over wall/bore. A
/// thicker tube has that of the thickest in the table. `None` for one thinner than the table's.
pub(super) fn suggested_kpa(bore_mm: f64, wall_mm: f64) -> Option<f64> {
    let ratio = wall_mm / bore_mm;
    let between = SUGGESTED.windows(2).find(|pair| ratio >= pair[0].0 && ratio <= pair[1].0);
    match between {
        Some(&[(low, at_low), (high, at_high)]) => {
            Some(at_low + (at_high - at_low) * (ratio - low) / (high - low))
        }
        _ => SUGGESTED.last().filter(|(most, _)| ratio > *most).map(|(_, kpa)| *kpa),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tables_own_sizes_have_its_pressures() {
        // Bore and wall in inches, psi: 1 psi is 6.894757 kPa.
        for (bore, wall, psi) in [
            (1.0 / 16.0, 1.0 / 16.0, 70.0),
            (1.0 / 8.0, 1.0 / 16.0, 43.0),
            (3.0 / 16.0, 1.0 / 16.0, 31.0),
            (1.0 / 4.0, 1.0 / 16.0, 25.0),
            (5.0 / 16.0, 1.0 / 16.0, 21.0),
            (3.0 / 8.0, 1.0 / 8.0, 31.0),
            (1.0 / 2.0, 1.0 / 8.0, 25.0),
            (3.0 / 4.0, 1.0 / 4.0, 31.0),
            (1.0, 3.0 / 16.0, 19.0),
            (2.0, 1.0 / 4.0, 14.0),
        ] {
            let kpa = suggested_kpa(25.4 * bore, 25.4 * wall).unwrap();
            assert!((kpa - psi * 6.894_757).abs() < 0.9, "{bore} x {wall}: {kpa}");
        }
        assert_eq!(suggested_kpa(10.0, 1.0), None);
        assert_eq!(suggested_kpa(0.5, 1.6), Some(482.0));
    }
}
