//! The bounds of a run until it is stopped.

use crate::safety::Stand;

/// Bounds of a run until it is stopped, beside those of every run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct RunBounds {
    /// Most steps that the device can count. `None` if it bounds none.
    pub(crate) steps: Option<u64>,
    /// Safety limit that leaves the least, with what is used of it. `None` without limits.
    pub(crate) safety: Option<Stand>,
}

impl RunBounds {
    /// Returns the most volume that the safety limits leave, in mL. Infinite without limits.
    pub(crate) fn safe_ml(&self) -> f64 {
        self.safety.map_or(f64::INFINITY, |stand| stand.left_ml())
    }
}
