//! A straight line through weighted points.

/// A run as a point of a fit.
pub(super) struct Point {
    /// Speed, r/min.
    pub(super) rpm: f64,
    /// Pressure at which segments were trapped, kPa absolute; 0 where no law is fitted.
    pub(super) trapped_kpa: f64,
    /// Measured over model volume.
    pub(super) ratio: f64,
    pub(super) weight: f64,
}

/// value + slope (x - reference), with the reference at the weighted mean, where value and slope are independent.
pub(super) struct Straight {
    pub(super) reference: f64,
    pub(super) value: f64,
    pub(super) slope: f64,
    /// Sum of the weights.
    pub(super) weight: f64,
    /// Weighted sum of the squared distances from the reference.
    pub(super) spread: f64,
}

impl Straight {
    /// Weighted least squares of the points' ratio over `x`; without `slope` the mean.
    pub(super) fn fit(points: &[Point], x: fn(&Point) -> f64, slope: bool) -> Self {
        let sum =
            |of: &dyn Fn(&Point) -> f64| points.iter().map(|point| point.weight * of(point)).sum::<f64>();
        let weight = sum(&|_| 1.0);
        let reference = sum(&|point| x(point)) / weight;
        let value = sum(&|point| point.ratio) / weight;
        let spread = sum(&|point| (x(point) - reference) * (x(point) - reference));
        let slope =
            if slope { sum(&|point| (x(point) - reference) * (point.ratio - value)) / spread } else { 0.0 };
        Self { reference, value, slope, weight, spread }
    }

    pub(super) fn at(&self, x: f64) -> f64 {
        self.value + self.slope * (x - self.reference)
    }
}
