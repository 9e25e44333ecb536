//! The bounds of a run until it is stopped.

/// Bounds of a run until it is stopped, beside those of every run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct RunBounds {
    /// Most steps that the device can count. `None` if it bounds none.
    pub(crate) steps: Option<u64>,
    /// Most volume that the safety limits leave, in mL. Infinite without limits.
    pub(crate) ml: f64,
}
