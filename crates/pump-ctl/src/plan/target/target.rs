//! The target: a number of steps and its volume.

/// A number of steps and the volume that they deliver.
pub(in crate::plan) struct Target {
    /// Number of motor steps. Negative in reverse.
    pub(in crate::plan) steps: i64,
    /// Volume V_out at the end angle less that at the start, mL. If the start angle is not stated
    /// ([`crate::plan::Phase::is_stated`]), it is the volume that the dose adds to the middle of all sums with the
    /// earlier doses.
    pub(in crate::plan) planned_ml: f64,
    /// Smallest and largest volume over the angles at which the rollers may stand, mL.
    pub(in crate::plan) range_ml: (f64, f64),
}
