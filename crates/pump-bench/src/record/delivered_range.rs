//! The volume that a dose has delivered, as far as the record knows it.

/// Volume that a dose, or one motion of it, has delivered. Negative in reverse.
///
/// It is unsure by the steps that nobody counted, and by the angle from which they were made. Whoever tells what a
/// dose has delivered tells this.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct DeliveredRange {
    /// Smallest volume, in mL.
    pub(crate) least_ml: f64,
    /// Volume that the dose is booked with, in mL.
    pub(crate) middle_ml: f64,
    /// Largest volume, in mL.
    pub(crate) most_ml: f64,
}

impl DeliveredRange {
    /// Returns the smallest and the largest volume, in mL.
    pub(crate) fn range_ml(&self) -> (f64, f64) {
        (self.least_ml, self.most_ml)
    }

    /// Returns the largest distance of the volume from the booked one, in mL.
    pub(crate) fn half_width_ml(&self) -> f64 {
        (self.middle_ml - self.least_ml).max(self.most_ml - self.middle_ml)
    }

    /// Returns the volume without `earlier_ml`, which is on record elsewhere.
    pub(crate) fn less(&self, earlier_ml: f64) -> Self {
        Self {
            least_ml: self.least_ml - earlier_ml,
            middle_ml: self.middle_ml - earlier_ml,
            most_ml: self.most_ml - earlier_ml,
        }
    }
}
