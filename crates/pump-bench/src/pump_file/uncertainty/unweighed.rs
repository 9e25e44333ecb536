//! Uncertainty of a pump that nobody has weighed.

use libm::sqrt;

/// Limits of the volume of a revolution, in percent, as one maker states them for heads and tubes of a kind: the bore
/// of the tube in mm, the limit between pumps and that between tubing materials (Omega FPU5MT, user's guide, table
/// 9-3; its bores are 1/32, 1/16, 1/8, 3/16, 1/4 and 5/16 in).
const LIMITS: [(f64, f64, f64); 6] = [
    (0.794, 25.0, 20.0),
    (1.588, 15.0, 15.0),
    (3.175, 10.0, 5.0),
    (4.763, 10.0, 5.0),
    (6.350, 15.0, 5.0),
    (7.938, 20.0, 10.0),
];

/// Largest deviation of the linear model from the measured volumes at a speed, in percent: 3 rollers, one of the
/// speeds from 10 to 170 r/min, McIntyre et al. Their raw figures, which would tell the speed, are not published. The
/// maker of table 9-3 states 5 to 15 % by the bore, up to 600 r/min.
const SPEED_LIMIT_PERCENT: f64 = 9.02;

/// Returns the standard uncertainty of the volume of a pump that nobody has weighed, in percent of the volume. The
/// tube's bore is in mm.
///
/// A limit L is a rectangle: L/sqrt(3) (GUM, JCGM 100:2008, 4.3.7). Pump and tubing are independent. A bore between
/// two of the table has the larger limits of both, and one beyond its ends those of the end.
pub(crate) fn model_percent(bore_mm: f64) -> f64 {
    let below = LIMITS.iter().rposition(|(mm, ..)| *mm <= bore_mm).unwrap_or(0);
    let above = LIMITS.iter().position(|(mm, ..)| bore_mm <= *mm).unwrap_or(LIMITS.len() - 1);
    percent_of(&[LIMITS[below], LIMITS[above]])
}

/// Returns the standard uncertainty of the volume of a pump that nobody has weighed and whose bore is not known, in
/// percent of the volume: that of the bore whose limits are the largest.
pub(crate) fn widest_percent() -> f64 {
    percent_of(&LIMITS)
}

/// Returns the standard uncertainty of the largest limits among these rows, in percent.
fn percent_of(rows: &[(f64, f64, f64)]) -> f64 {
    let largest = |limit: fn(&(f64, f64, f64)) -> f64| rows.iter().map(limit).fold(0.0, f64::max);
    let (between_pumps, between_tubes) = (largest(|row| row.1), largest(|row| row.2));
    sqrt((between_pumps * between_pumps + between_tubes * between_tubes) / 3.0)
}

/// Returns the standard uncertainty of the volume at a speed of a pump that nobody has weighed, in percent of the
/// volume: a rectangle over the largest deviation at one speed of McIntyre et al.
pub(crate) fn speed_percent() -> f64 {
    SPEED_LIMIT_PERCENT / sqrt(3.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pumps_that_nobody_weighed_are_as_unsure_as_their_maker_states() {
        // sqrt(20² + 10²)/sqrt(3), sqrt(10² + 5²)/sqrt(3), sqrt(25² + 20²)/sqrt(3), sqrt(15² + 15²)/sqrt(3).
        for (bore_mm, percent) in
            [(10.0, 12.910), (7.9, 12.910), (4.0, 6.455), (0.5, 18.484), (1.0, 18.484), (2.0, 12.247)]
        {
            assert!((model_percent(bore_mm) - percent).abs() < 1e-3, "{bore_mm} mm");
        }
        // sqrt(25² + 20²)/sqrt(3).
        assert!((widest_percent() - 18.484).abs() < 1e-3);
        assert!((speed_percent() - 5.208).abs() < 1e-3);
    }
}
