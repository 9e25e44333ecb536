//! The pressure that tubes for roller pumps bear, as a maker rates them.

/// Millimetres in an inch (by definition).
const MM_PER_INCH: f64 = 25.4;

/// Bore, in inches, and largest working pressure, in kPa, of tubes for roller pumps at 23 °C, a fifth of their burst
/// pressure: Saint-Gobain, Peristaltic Pump Tubing, Pressure Ratings
/// (processsystems.saint-gobain.com/product_detail.aspx?id=258992). A wider bore with a thicker wall bears as much as a
/// narrower one, so each bore has the largest rating of the bores from it on.
const RATINGS: [(f64, f64); 6] = [
    (1.0 / 16.0, 482.0),
    (1.0 / 8.0, 296.0),
    (3.0 / 16.0, 214.0),
    (3.0 / 4.0, 214.0),
    (1.0, 131.0),
    (2.0, 96.0),
];

/// Part of a bore by which a metric size may be wider than the size in inches that it stands for: 1.6 mm for 1/16 in.
const SAME_SIZE: f64 = 0.02;

/// Returns the largest working pressure of tubes with a bore in mm, in kPa above the air's: that of the next wider bore
/// that is rated. `None` as the bore takes the largest rating.
pub(super) fn rated_kpa(bore_mm: Option<f64>) -> f64 {
    let bore_mm = bore_mm.unwrap_or(0.0);
    let holds = |inches: f64| bore_mm <= (1.0 + SAME_SIZE) * inches * MM_PER_INCH;
    let rated = RATINGS.iter().find(|(inches, _)| holds(*inches));
    rated.unwrap_or(&RATINGS[RATINGS.len() - 1]).1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bore_has_the_rating_of_the_next_wider_one() {
        for (bore_mm, kpa) in [
            (Some(1.0), 482.0),
            (Some(1.6), 482.0),
            (Some(2.0), 296.0),
            (Some(3.1), 296.0),
            (Some(3.2), 296.0),
            (Some(10.0), 214.0),
            (Some(25.4), 131.0),
            (None, 482.0),
        ] {
            assert_eq!(rated_kpa(bore_mm), kpa, "{bore_mm:?}");
        }
        assert_eq!(rated_kpa(Some(100.0)), 96.0);
    }
}
