//! The drift of a tube over its calibrations.

use libm::{fabs, sqrt};

/// Days for which a drift is told.
const TOLD_DAYS: f64 = 30.0;

/// Coverage factor of the bounds (GUM, 6.2).
const COVERAGE: f64 = 2.0;

/// Fewest calibrations that show a drift: two show a line and nothing of its scatter.
pub const DRIFT_NEEDS: usize = 3;

/// Length of a day, in s.
const DAY_S: f64 = 86_400.0;

/// Factor of a calibration at its time.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct FactorAtTime {
    /// Time of the calibration, in seconds since 1970.
    pub unix_s: u64,
    /// Measured over model volume.
    pub factor: f64,
    /// Standard uncertainty of the factor.
    pub standard: f64,
}

impl FactorAtTime {
    /// Names a factor with its standard uncertainty at a time in seconds since 1970.
    pub fn new(unix_s: u64, factor: f64, standard: f64) -> Self {
        Self { unix_s, factor, standard }
    }
}

/// Drift of a tube: the change of its factor with the time.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Drift {
    /// Change of the factor in a day.
    pub per_day: f64,
    /// Standard uncertainty of that change.
    pub standard_per_day: f64,
    /// Time after the present calibration from which on the upper bound (k = 2) of the drift exceeds the calibration's
    /// expanded uncertainty, in days. `None` where that never comes.
    pub days: Option<f64>,
}

impl Drift {
    /// Fits a straight line to the factors of three calibrations or more, each weighted by its standard uncertainty.
    /// The last one is the present calibration. Returns `None` with fewer calibrations, with all at one time, or where
    /// the uncertainty of the drift in 30 days exceeds the factor itself: their span is too short to tell it.
    ///
    /// The slope of weighted least squares is b = sum w (t - t0) y / sum w (t - t0)^2, w = 1 / u^2, with t0 the
    /// weighted mean time, and its variance 1 / sum w (t - t0)^2 (Bevington and Robinson, Data Reduction and
    /// Error Analysis, 3rd ed., section 6.4). Factors that scatter more than their uncertainties say widen it
    /// by the Birge ratio (Birge, Phys. Rev. 40, 207 (1932)).
    pub fn of(factors: &[FactorAtTime]) -> Option<Self> {
        let last = factors.last().filter(|_| factors.len() >= DRIFT_NEEDS)?;
        let usable =
            |at: &FactorAtTime| at.standard > 0.0 && at.standard.is_finite() && at.factor.is_finite();
        if !factors.iter().all(usable) {
            return None;
        }
        let days = |at: &FactorAtTime| (at.unix_s as f64 - last.unix_s as f64) / DAY_S;
        let weight = |at: &FactorAtTime| 1.0 / (at.standard * at.standard);
        let sum = |of: &dyn Fn(&FactorAtTime) -> f64| factors.iter().map(of).sum::<f64>();
        let total = sum(&|at| weight(at));
        let mean_days = sum(&|at| weight(at) * days(at)) / total;
        let mean_factor = sum(&|at| weight(at) * at.factor) / total;
        let spread = sum(&|at| weight(at) * (days(at) - mean_days) * (days(at) - mean_days));
        if spread <= 0.0 {
            return None;
        }
        let per_day = sum(&|at| weight(at) * (days(at) - mean_days) * at.factor) / spread;
        let departure = |at: &FactorAtTime| at.factor - mean_factor - per_day * (days(at) - mean_days);
        let chi_squared = sum(&|at| weight(at) * departure(at) * departure(at));
        let birge = sqrt(chi_squared / (factors.len() - 2) as f64).max(1.0);
        let standard_per_day = birge / sqrt(spread);
        if COVERAGE * standard_per_day * TOLD_DAYS > last.factor {
            return None;
        }
        let fastest_per_day = fabs(per_day) + COVERAGE * standard_per_day;
        let days = COVERAGE * last.standard / fastest_per_day;
        Some(Self { per_day, standard_per_day, days: Some(days).filter(|days| days.is_finite()) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const START: u64 = 1_700_000_000;

    fn factors(days_factors: &[(u64, f64, f64)]) -> Vec<FactorAtTime> {
        days_factors
            .iter()
            .map(|(day, factor, u)| FactorAtTime::new(START + day * 86_400, *factor, *u))
            .collect()
    }

    fn close(a: f64, b: f64) -> bool {
        (a - b).abs() <= 1e-6 * b.abs()
    }

    #[test]
    fn a_drift_is_that_of_an_independent_fit_and_two_calibrations_show_none() {
        let all = factors(&[(0, 1.010, 0.001), (20, 1.006, 0.002), (50, 1.001, 0.001), (90, 0.992, 0.0015)]);
        for few in [&all[..0], &all[..1], &all[..2]] {
            assert_eq!(Drift::of(few), None);
        }
        let drift = Drift::of(&all).unwrap();
        // numpy.polyfit(days, y, 1, w=1/u, cov="unscaled"): the residuals are smaller than the uncertainties.
        assert!(close(drift.per_day, -1.948_282_097_649e-4), "{drift:?}");
        assert!(close(drift.standard_per_day, 1.873_002_250_98e-5), "{drift:?}");
    }

    #[test]
    fn a_calibration_is_due_at_the_instant_from_which_the_bound_exceeds_it() {
        let all = factors(&[(0, 1.0, 0.001), (50, 0.99, 0.001), (100, 0.98, 0.001)]);
        let drift = Drift::of(&all).unwrap();
        // The times stand 50 days apart, so the slope is unsure by 0.001 / (50 sqrt 2) a day.
        let fastest = 2e-4 + 2.0 * 0.001 / (50.0 * 2f64.sqrt());
        let days = drift.days.unwrap();
        assert!(close(drift.per_day, -2e-4) && close(days * fastest, 0.002), "{drift:?}");
    }

    #[test]
    fn factors_that_scatter_widen_the_drift_and_one_time_shows_none() {
        let quiet = Drift::of(&factors(&[(0, 1.0, 1e-3), (10, 1.0, 1e-3), (20, 1.0, 1e-3)])).unwrap();
        let scattered = Drift::of(&factors(&[(0, 1.0, 1e-3), (10, 1.01, 1e-3), (20, 1.0, 1e-3)])).unwrap();
        assert!(scattered.standard_per_day > 5.0 * quiet.standard_per_day);
        assert_eq!(Drift::of(&factors(&[(5, 1.0, 1e-3), (5, 1.01, 1e-3), (5, 1.0, 1e-3)])), None);
        // Minutes apart, factors that are known to 1 % tell nothing of 30 days.
        let minutes = |minute: u64, factor| FactorAtTime::new(START + 60 * minute, factor, 0.01);
        assert_eq!(Drift::of(&[minutes(0, 1.0), minutes(1, 0.99), minutes(3, 1.01)]), None);
        assert_eq!(Drift::of(&factors(&[(0, 1.0, 0.0), (10, 1.0, 1e-3), (20, 1.0, 1e-3)])), None);
    }
}
