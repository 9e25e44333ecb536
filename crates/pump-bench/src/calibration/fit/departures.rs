//! Departures of the runs from a fit: scatter, lack of fit, and outliers.

use std::num::NonZeroU32;

use libm::sqrt;

/// A run further than this many robust standard deviations from the line is an outlier (Iglewicz and Hoaglin,
/// "How to Detect and Handle Outliers", ASQC 1993: modified z-score above 3.5).
const OUTLYING: f64 = 3.5;

/// Standard deviation of a normal distribution over its median absolute deviation.
const SIGMA_OF_MEDIAN: f64 = 1.482_602_218_505_602;

/// Departure of a run from a fit.
#[derive(Debug, Clone, Copy)]
pub(super) struct Departure {
    /// Number of the run, from 1.
    pub(super) run: usize,
    /// Measured over model volume, less that of the fit, as a part of the measured volume.
    pub(super) residual: f64,
    /// Weight of the run: 1 over its expected variance.
    pub(super) weight: f64,
}

/// Departures of the runs from a fit, in a group for each speed.
pub(super) struct Departures {
    by_speed: Vec<Vec<Departure>>,
    /// Number of runs.
    runs: usize,
}

/// Variance of the runs over the variance that was expected of them.
#[derive(Debug, Clone, Copy)]
pub(super) struct VarianceRatio {
    /// Degrees of freedom.
    pub(super) degrees_of_freedom: NonZeroU32,
    /// Variance ratio.
    pub(super) ratio: f64,
}

impl Departures {
    pub(super) fn new(by_speed: Vec<Vec<Departure>>) -> Self {
        let runs = by_speed.iter().map(Vec::len).sum();
        Self { by_speed, runs }
    }

    /// Number of runs.
    pub(super) fn runs(&self) -> usize {
        self.runs
    }

    /// True if at least one speed has more runs than one.
    fn repeated(&self) -> bool {
        self.runs > self.by_speed.len()
    }

    /// Returns the variance of the runs at one speed over the expected variance. Returns `None` without
    /// degrees of freedom.
    ///
    /// Where no speed was repeated, the variance is that of the runs about the fit, which has so many
    /// `parameters`. The distance of the speeds' means from the fit is the lack of fit, and counts once.
    pub(super) fn variance_ratio(&self, parameters: usize) -> Option<VarianceRatio> {
        let repeated = self.repeated();
        let used = if repeated { self.by_speed.len() } else { parameters };
        let degrees_of_freedom = NonZeroU32::new(self.runs.saturating_sub(used) as u32)?;
        let squares = self.by_speed.iter().map(|group| {
            let middle = if repeated { mean(group) } else { 0.0 };
            let weighted = |one: &Departure| one.weight * (one.residual - middle) * (one.residual - middle);
            group.iter().map(weighted).sum::<f64>()
        });
        let ratio = squares.sum::<f64>() / f64::from(degrees_of_freedom.get());
        Some(VarianceRatio { degrees_of_freedom, ratio })
    }

    /// Returns the standard deviation of the speeds' means about the fit beyond the scatter within the
    /// speeds, as a part of the volume. The fit has so many `parameters`. It is 0 with no more speeds than
    /// parameters, or where no speed was repeated.
    pub(super) fn lack_of_fit(&self, parameters: usize) -> f64 {
        let (speeds, runs) = (self.by_speed.len(), self.runs);
        if speeds <= parameters || !self.repeated() {
            return 0.0;
        }
        let (mut between, mut within) = (0.0, 0.0);
        for group in &self.by_speed {
            let mean = mean(group);
            between += group.len() as f64 * mean * mean;
            within += group.iter().map(|one| (one.residual - mean) * (one.residual - mean)).sum::<f64>();
        }
        let excess = between / (speeds - parameters) as f64 - within / (runs - speeds) as f64;
        sqrt(excess.max(0.0) * speeds as f64 / runs as f64)
    }

    /// Returns the numbers of the runs, from 1, that lie far from the median of their speed. Where no speed
    /// was repeated, the runs count from the fit.
    ///
    /// The robust standard deviation is taken as half of `sigma`, the deviation that was expected, or more,
    /// however much the runs agree.
    pub(super) fn outliers(&self, sigma: f64) -> Vec<usize> {
        let repeated = self.repeated();
        let mut distances = Vec::new();
        for group in &self.by_speed {
            let mut residuals: Vec<f64> = group.iter().map(|one| one.residual).collect();
            residuals.sort_unstable_by(f64::total_cmp);
            let middle = residuals.get(residuals.len() / 2).copied().unwrap_or(0.0);
            let median = if repeated { middle } else { 0.0 };
            distances.extend(group.iter().map(|one| (one.run, (one.residual - median).abs())));
        }
        let mut sorted: Vec<f64> = distances.iter().map(|(_, distance)| *distance).collect();
        sorted.sort_unstable_by(f64::total_cmp);
        // The median of each speed is at no distance from itself and says nothing of the scatter.
        let telling = sorted.get(if repeated { self.by_speed.len() } else { 0 }..).unwrap_or(&[]);
        let median = telling.get(telling.len() / 2).copied().unwrap_or(0.0);
        let robust = (SIGMA_OF_MEDIAN * median).max(0.5 * sigma);
        let far = |(run, distance): &(usize, f64)| (*distance > OUTLYING * robust).then_some(*run);
        let mut far: Vec<usize> = distances.iter().filter_map(far).collect();
        far.sort_unstable();
        far
    }
}

fn mean(group: &[Departure]) -> f64 {
    group.iter().map(|one| one.residual).sum::<f64>() / group.len() as f64
}
