//! A number of steps and its volume.

/// A number of steps and the volume that they deliver.
pub(in crate::plan) struct Target {
    /// Motor steps; negative in reverse.
    pub(in crate::plan) steps: i64,
    /// V_out of the end angle less that of the start, mL; the middle of `range_ml`.
    pub(in crate::plan) planned_ml: f64,
    /// Smallest and largest volume from the angles at which the rollers may stand, mL.
    pub(in crate::plan) range_ml: (f64, f64),
}
