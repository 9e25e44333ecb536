//! Measurements beside their fit, and the names of their axes.

/// A measurement beside its fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fitted {
    /// Place on the horizontal axis.
    pub x: f64,
    /// Measured value.
    pub measured: f64,
    /// Value of the fit at this place.
    pub fitted: f64,
}

/// Names of the axes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Axes {
    /// Name of the horizontal axis, with its unit.
    pub x: &'static str,
    /// Name of the measured quantity, with its unit.
    pub y: &'static str,
    /// Name of the residual, measured less fitted, with its unit.
    pub left: &'static str,
}
