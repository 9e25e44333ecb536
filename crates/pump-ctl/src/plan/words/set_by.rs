//! The origin of the smallest pressure at a port.

use core::fmt;

/// The origin of the smallest pressure at a port, for messages and reports.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum SetBy {
    /// The user gave the pressure.
    Given,
    /// The tube would collapse at the pressure.
    TubeCollapse,
    /// The pressure is the fluid's vapour pressure.
    Vapour,
}

impl SetBy {
    /// Returns the origin's name in reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Given => "given",
            Self::TubeCollapse => "tube_collapse",
            Self::Vapour => "vapour_pressure",
        }
    }
}

impl fmt::Display for SetBy {
    /// Writes the words that follow the pressure in a message. A pressure that was given has none.
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        to.write_str(match self {
            Self::Given => "",
            Self::TubeCollapse => ", at which the tube would collapse (thin-wall estimate)",
            Self::Vapour => ", the fluid's vapour pressure",
        })
    }
}
