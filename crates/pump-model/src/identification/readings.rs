//! The kinds of readings that a fit takes.

use core::fmt;

/// Kind of the readings that a fit takes. `Display` writes the plural that errors use.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Readings {
    /// Points of flow and pressure, for a resistance.
    FlowPoints,
    /// Points of volume and pressure, for a compliance.
    VolumePoints,
    /// Samples of pressure, for a waveform.
    Samples,
}

impl Readings {
    /// Returns the name of a single reading: `point` or `sample`.
    pub const fn single(self) -> &'static str {
        match self {
            Self::FlowPoints | Self::VolumePoints => "point",
            Self::Samples => "sample",
        }
    }
}

impl fmt::Display for Readings {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        to.write_str(match self {
            Self::FlowPoints => "points of flow and pressure",
            Self::VolumePoints => "points of volume and pressure",
            Self::Samples => "samples of pressure",
        })
    }
}
