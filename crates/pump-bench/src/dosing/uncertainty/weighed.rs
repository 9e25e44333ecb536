//! Uncertainty of a volume that was weighed.

use libm::sqrt;

use super::COVERAGE_FACTOR;
use super::share::{Share, ShareSource};
use crate::calibration::{CalibrationError, Weighing};
use crate::pump_file::PumpFile;

/// Returns the shares of a volume of `volume_ml` that a balance showed, and the expanded uncertainty in mL, k = 2.
///
/// `reading_ml` is the standard uncertainty of the difference of two readings. A drop of `drop_ml` hangs at the
/// nozzle and
/// may fall yet: rectangular, V/sqrt(12) (GUM, JCGM 100:2008, 4.3.7). Before the dose another hung there, which the
/// balance has seen fall.
///
/// # Errors
///
/// [`CalibrationError`] if the density of the fluid is not known.
pub(crate) fn weighed_shares(
    file: &PumpFile,
    volume_ml: f64,
    reading_ml: f64,
    drop_ml: f64,
) -> Result<(Vec<Share>, f64), CalibrationError> {
    let density = Weighing::of(file).density_standard()?;
    let mut shares = vec![
        Share::new(ShareSource::Balance, reading_ml),
        Share::new(ShareSource::Density, density * volume_ml.abs()),
        Share::new(ShareSource::Drop, drop_ml / sqrt(12.0)),
    ];
    let variance: f64 = shares.iter().map(|share| share.standard_ml * share.standard_ml).sum();
    for share in shares.iter_mut().filter(|_| variance > 0.0) {
        share.variance_percent = 100.0 * share.standard_ml * share.standard_ml / variance;
    }
    Ok((shares, COVERAGE_FACTOR * sqrt(variance)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shares_are_those_of_reading_density_and_drop() {
        let file = crate::catalogue::built_in("three-roller").unwrap();
        let (shares, expanded_ml) = weighed_shares(&file, 25.0, 0.004, 0.03).unwrap();
        // Water at 25 °C grows by 2.57e-4 a degree (CRC Handbook), 0.8 °C are 2.06e-4 of 25 mL.
        assert!((shares[1].standard_ml - 25.0 * 2.06e-4).abs() < 1e-4, "{shares:?}");
        assert!((shares[2].standard_ml - 0.00866).abs() < 1e-5);
        let sum = (0.004_f64.powi(2) + shares[1].standard_ml.powi(2) + 0.00866_f64.powi(2)).sqrt();
        assert!((expanded_ml - 2.0 * sum).abs() < 1e-5, "{expanded_ml}");
    }
}
