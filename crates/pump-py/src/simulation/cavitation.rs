//! Warnings of pressures that no liquid can have.

use pump_bench::report::cavitation_warning;
use pyo3::prelude::*;

use crate::python::warnings::warn;

/// Pressures of the points of a result, kPa absolute.
pub(super) struct Pressures<'a> {
    pub(super) inlet_kpa: &'a [f64],
    pub(super) outlet_kpa: &'a [f64],
}

impl Pressures<'_> {
    /// Warns once if a pressure is below 0, with the lowest of all. `place` tells where a point is, after its port.
    pub(super) fn warn(&self, py: Python<'_>, place: impl Fn(usize) -> String) -> PyResult<()> {
        let ports = [("inlet", self.inlet_kpa), ("outlet", self.outlet_kpa)];
        let all = ports.iter().flat_map(|(port, kpa)| kpa.iter().enumerate().map(move |at| (*port, at)));
        let below = all.filter(|(_, (_, kpa))| **kpa < 0.0);
        let Some((port, (point, kpa))) = below.min_by(|(_, (_, one)), (_, (_, other))| one.total_cmp(other))
        else {
            return Ok(());
        };
        warn(py, &[cavitation_warning(*kpa, format_args!("{port}{}", place(point)))])
    }

    /// Returns the number of points with a pressure below 0.
    pub(super) fn below(&self) -> usize {
        self.inlet_kpa.iter().zip(self.outlet_kpa).filter(|(one, other)| one.min(**other) < 0.0).count()
    }
}

/// Returns the warning of a pressure below 0 at a place.
#[pyfunction]
pub(crate) fn _cavitation(kpa: f64, place: &str) -> String {
    cavitation_warning(kpa, place)
}
