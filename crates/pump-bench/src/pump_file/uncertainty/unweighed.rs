//! Uncertainty of a pump that nobody has weighed.

use libm::sqrt;

/// Limits of the volume of a revolution for tubes of one bore, in percent of the volume, as a maker states them.
#[derive(Clone, Copy)]
struct Limits {
    /// Bore of the tube, in mm.
    bore_mm: f64,
    /// Limit over the speeds of the motor.
    speed: f64,
    /// Limit between pumps.
    pump: f64,
    /// Limit between tubing materials.
    tube: f64,
}

const fn limits(bore_mm: f64, speed: f64, pump: f64, tube: f64) -> Limits {
    Limits { bore_mm, speed, pump, tube }
}

/// Limits by the bore (Omega FPU5MT, user's guide, table 9-3; its bores are 1/32, 1/16, 1/8, 3/16, 1/4 and 5/16 in, its
/// speeds 10 to 600 r/min). The 9.02 % by which McIntyre et al. found their model off at one speed, with a bore of 10
/// mm, lie within the 15 % of the widest.
const TABLE: [Limits; 6] = [
    limits(0.794, 10.0, 25.0, 20.0),
    limits(1.588, 10.0, 15.0, 15.0),
    limits(3.175, 10.0, 10.0, 5.0),
    limits(4.763, 5.0, 10.0, 5.0),
    limits(6.350, 5.0, 15.0, 5.0),
    limits(7.938, 15.0, 20.0, 10.0),
];

/// Standard uncertainties of the volume of a pump that nobody has weighed, in percent of the volume.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Unweighed {
    /// Uncertainty between pumps and tubes of one kind.
    pub(crate) model_percent: f64,
    /// Uncertainty over the speeds.
    pub(crate) speed_percent: f64,
}

impl Unweighed {
    /// Returns the uncertainties for a tube of this bore, in mm. Without a bore the largest limits of the table count.
    ///
    /// A bore between two of the table has the larger limits of both, and one beyond its ends those of the end.
    pub(crate) fn of_bore(bore_mm: Option<f64>) -> Self {
        let Some(bore_mm) = bore_mm else { return Self::of_largest(&TABLE) };
        let below = TABLE.iter().rposition(|row| row.bore_mm <= bore_mm).unwrap_or(0);
        let above = TABLE.iter().position(|row| bore_mm <= row.bore_mm).unwrap_or(TABLE.len() - 1);
        Self::of_largest(&[TABLE[below], TABLE[above]])
    }

    /// Returns the uncertainties of the largest limits of these rows.
    ///
    /// A limit L is a rectangle: L/sqrt(3) (GUM, JCGM 100:2008, 4.3.7). Pump and tubing are independent.
    fn of_largest(rows: &[Limits]) -> Self {
        let largest = |limit: fn(&Limits) -> f64| rows.iter().map(limit).fold(0.0, f64::max);
        let (pump, tube) = (largest(|row| row.pump), largest(|row| row.tube));
        Self {
            model_percent: sqrt((pump * pump + tube * tube) / 3.0),
            speed_percent: largest(|row| row.speed) / sqrt(3.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pumps_that_nobody_weighed_are_as_unsure_as_their_maker_states() {
        // sqrt(20² + 10²)/sqrt(3), sqrt(10² + 5²)/sqrt(3), sqrt(25² + 20²)/sqrt(3), sqrt(15² + 15²)/sqrt(3); 15, 10
        // and 5 over sqrt(3).
        for (bore_mm, model_percent, speed_percent) in [
            (Some(10.0), 12.910, 8.660),
            (Some(7.9), 12.910, 8.660),
            (Some(5.0), 9.129, 2.887),
            (Some(4.0), 6.455, 5.774),
            (Some(0.5), 18.484, 5.774),
            (Some(1.0), 18.484, 5.774),
            (Some(2.0), 12.247, 5.774),
            (None, 18.484, 8.660),
        ] {
            let found = Unweighed::of_bore(bore_mm);
            assert!((found.model_percent - model_percent).abs() < 1e-3, "{bore_mm:?} mm: {found:?}");
            assert!((found.speed_percent - speed_percent).abs() < 1e-3, "{bore_mm:?} mm: {found:?}");
        }
    }
}
