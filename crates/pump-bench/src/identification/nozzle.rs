//! The nozzle of a pump file, which a table of the identified line keeps.

use crate::pump_file::{OutletEnd, PumpFile};

/// Nozzle at the end of the outlet's line, as a pump file says it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Nozzle {
    /// Place of the nozzle's end, if the pump file names it.
    pub end: Option<OutletEnd>,
    /// Diameter from which a drop hangs, in mm, if the pump file tells it: that of the nozzle, or else the bore of
    /// the hose, which the identified line replaces.
    pub bore_mm: Option<f64>,
}

impl Nozzle {
    /// Returns the nozzle of `file`.
    pub(crate) fn of(file: &PumpFile) -> Self {
        let outlet = &file.outlet;
        let is_told = outlet.nozzle_bore_mm.is_some() || outlet.line.hose().is_some();
        Self { end: outlet.end, bore_mm: is_told.then(|| outlet.nozzle_mm()) }
    }
}
