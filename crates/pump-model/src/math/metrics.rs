//! Metrics of a model against measurements: RMSE, NRMSE and Pearson's correlation, as McIntyre et al. report
//! them.
//!
//! All take pairs (by the model, measured). They return none where the number has no meaning, never a number
//! that pretends.

use libm::sqrt;

/// Returns the root of the mean square of model less measured, in their unit; none without pairs.
pub fn rmse(pairs: impl IntoIterator<Item = (f64, f64)>) -> Option<f64> {
    let (mut count, mut square) = (0.0, 0.0);
    for (model, measured) in pairs {
        count += 1.0;
        square += (model - measured) * (model - measured);
    }
    (count > 0.0).then(|| sqrt(square / count))
}

/// Returns the RMSE over the mean of the measured values, as a fraction without sign.
///
/// McIntyre et al. report 2.37 % and 1.97 %, which this normaliser meets. Others divide by the range. For
/// pressures, whose mean is mostly ambient, that number is much larger.
///
/// Returns none without pairs, and for measured values whose mean is 0.
///
/// ```
/// let nrmse = pump_model::metrics::nrmse([(210.0, 200.0), (190.0, 200.0)]);
/// assert_eq!(nrmse, Some(0.05));
/// ```
pub fn nrmse(pairs: impl IntoIterator<Item = (f64, f64)> + Clone) -> Option<f64> {
    let (mut count, mut sum) = (0.0, 0.0);
    for (_, measured) in pairs.clone() {
        count += 1.0;
        sum += measured;
    }
    let mean = (sum / count).abs();
    rmse(pairs).map(|rmse| rmse / mean).filter(|nrmse| nrmse.is_finite())
}

/// Returns Pearson's correlation, -1 to 1. It tells how far both rise and fall together, independent of their
/// size.
///
/// Returns none if either does not change.
pub fn pearson(pairs: impl IntoIterator<Item = (f64, f64)>) -> Option<f64> {
    // Means and moments are updated together (Welford, "Note on a method for calculating corrected sums of
    // squares and products", Technometrics 4, 1962): nothing cancels where the mean is large.
    let (mut count, mut mean_x, mut mean_y) = (0.0, 0.0, 0.0);
    let (mut square_x, mut square_y, mut product) = (0.0, 0.0, 0.0);
    for (x, y) in pairs {
        count += 1.0;
        let (from_x, from_y) = (x - mean_x, y - mean_y);
        mean_x += from_x / count;
        mean_y += from_y / count;
        square_x += from_x * (x - mean_x);
        square_y += from_y * (y - mean_y);
        product += from_x * (y - mean_y);
    }
    let pearson = product / (sqrt(square_x) * sqrt(square_y));
    // Rounding may leave the range by a bit.
    pearson.is_finite().then(|| pearson.clamp(-1.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn metrics_are_those_of_a_sum_done_by_hand() {
        // Anscombe's first set (American Statistician 27, 1973): correlation 0.816.
        let x = [10.0, 8.0, 13.0, 9.0, 11.0, 14.0, 6.0, 4.0, 12.0, 7.0, 5.0];
        let y = [8.04, 6.95, 7.58, 8.81, 8.33, 9.96, 7.24, 4.26, 10.84, 4.82, 5.68];
        let pairs = x.into_iter().zip(y);
        assert!((pearson(pairs.clone()).unwrap() - 0.816_420_5).abs() < 1e-6);
        assert!((pearson(pairs.clone().map(|(x, y)| (x, -y))).unwrap() + 0.816_420_5).abs() < 1e-6);
        let far = pairs.clone().map(|(x, y)| (x + 1e7, y - 3e7));
        assert!((pearson(far).unwrap() - 0.816_420_5).abs() < 1e-6, "a large mean costs nothing");
        let three = [(1.0, 2.0), (4.0, 2.0), (2.0, 8.0)];
        let by_hand = sqrt((1.0 + 4.0 + 36.0) / 3.0);
        assert_eq!(rmse(three), Some(by_hand));
        assert_eq!(nrmse(three), Some(by_hand / 4.0));
        assert_eq!(nrmse(three.map(|(x, y)| (-x, -y))), Some(by_hand / 4.0));
    }

    #[test]
    fn what_has_no_meaning_has_no_number() {
        assert_eq!((rmse([]), nrmse([]), pearson([])), (None, None, None));
        assert_eq!(nrmse([(1.0, 1.0), (1.0, -1.0)]), None, "the mean is 0");
        assert_eq!(pearson([(1.0, 2.0), (2.0, 2.0)]), None, "nothing changes");
        assert_eq!(pearson([(1.0, 2.0)]), None);
        assert_eq!(pearson([(1.0, 2.0), (f64::NAN, 3.0)]), None);
        assert!(pearson([(1.0, 3.0), (2.0, 5.0)]).unwrap() > 1.0 - 1e-15);
    }
}
