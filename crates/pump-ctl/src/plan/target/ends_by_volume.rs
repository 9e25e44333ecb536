//! The ends at low flow that are nearest by their volume, on a head whose flow reverses.

use libm::floor;

/// The ends nearest to a volume: the largest that is no more, and the smallest that is no less.
///
/// Where the flow reverses, an end with fewer steps may have a larger volume. So the number of steps does not tell
/// which end is nearest.
pub(super) struct EndsByVolume<F> {
    /// Volume in the direction of the dose, mL, of a number of steps.
    volume_ml: F,
    /// Volume to deliver, mL, not negative.
    owed_ml: f64,
    /// Steps and volume of the two ends.
    pub(super) below: Option<(f64, f64)>,
    pub(super) above: Option<(f64, f64)>,
}

impl<F: Fn(f64) -> f64> EndsByVolume<F> {
    /// Starts with no end.
    pub(super) fn new(owed_ml: f64, volume_ml: F) -> Self {
        Self { volume_ml, owed_ml, below: None, above: None }
    }

    /// Looks at the ends of a stretch of low flow, from `first` to `last` steps. The volume grows there.
    #[cold]
    #[inline(never)]
    pub(super) fn look(&mut self, first: f64, last: f64) {
        let (mut low, mut high) = (first, last);
        let [mut low_ml, mut high_ml] = [low, high].map(&self.volume_ml);
        while high - low > 1.0 && low_ml < self.owed_ml && high_ml > self.owed_ml {
            let middle = floor(0.5 * (low + high));
            let middle_ml = (self.volume_ml)(middle);
            if middle_ml <= self.owed_ml {
                (low, low_ml) = (middle, middle_ml);
            } else {
                (high, high_ml) = (middle, middle_ml);
            }
        }
        for (steps, ml) in [(low, low_ml), (high, high_ml)] {
            if ml <= self.owed_ml && self.below.is_none_or(|(_, before_ml)| ml > before_ml) {
                self.below = Some((steps, ml));
            }
            if ml >= self.owed_ml && self.above.is_none_or(|(_, before_ml)| ml < before_ml) {
                self.above = Some((steps, ml));
            }
        }
    }
}
