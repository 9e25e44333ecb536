//! The two ends of the pump.

/// An end of the pump.
///
/// The enum is exhaustive on purpose: a pump has two ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Port {
    /// The end that sucks in forward motion.
    Inlet,
    /// The end that delivers in forward motion.
    Outlet,
}

impl Port {
    /// Returns the port's name: `inlet` or `outlet`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Inlet => "inlet",
            Self::Outlet => "outlet",
        }
    }
}
