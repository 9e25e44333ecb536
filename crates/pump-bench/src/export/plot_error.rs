//! The error of a picture.

/// A picture that could not be drawn.
#[derive(Debug, thiserror::Error)]
#[error("the plot could not be drawn: {reason}")]
#[non_exhaustive]
pub struct PlotError {
    /// Cause of the failure.
    pub reason: String,
}
