//! The largest pressure that is allowed at the outlet.

use crate::heads::BoughtHead;
use crate::pump_file::PumpFile;

use super::working_pressure::suggested_kpa;

/// The largest pressure that is allowed at the outlet.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct LargestPressure {
    /// Pressure, in kPa absolute.
    pub kpa: f64,
    /// Source of the pressure.
    pub source: PressureSource,
}

/// Source of the largest pressure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PressureSource {
    /// The pump file or the request gives it.
    Given,
    /// A maker of tubing suggests it for wall and bore of the head's tube.
    Tubing,
}

impl PressureSource {
    /// Returns the source's name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Given => "given",
            Self::Tubing => "tubing",
        }
    }

    /// Returns the words that follow the pressure in a message.
    pub(super) fn told(self) -> &'static str {
        match self {
            Self::Given => ", as given",
            Self::Tubing => ", the working pressure that a maker suggests for tubing of this wall and bore",
        }
    }
}

/// Returns the largest pressure at the outlet: the one given, or that of the head's tubing.
pub(super) fn largest_pressure(file: &PumpFile, head: Option<&BoughtHead>) -> Option<LargestPressure> {
    let given = file.limits.max_outlet_kpa.map(|kpa| LargestPressure { kpa, source: PressureSource::Given });
    given.or_else(|| {
        let gauge_kpa = suggested_kpa(head?.bore_mm?, head?.wall_mm?)?;
        Some(LargestPressure { kpa: file.ambient.pressure_kpa + gauge_kpa, source: PressureSource::Tubing })
    })
}
