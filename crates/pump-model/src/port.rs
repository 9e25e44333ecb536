//! The two ends of the pump.

use core::fmt;

/// An end of the pump.
///
/// The enum is exhaustive on purpose: a pump has two ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
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

impl fmt::Display for Port {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        to.pad(self.name())
    }
}
