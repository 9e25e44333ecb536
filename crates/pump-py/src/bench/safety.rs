//! The safety limits of a bench: the word of a person to a pump that stands.

use pyo3::prelude::*;

use super::bench::Bench;
use super::homing::Told;
use super::worker::Named;

#[pymethods]
impl Bench {
    /// Clears the stand of the pump at a safety limit.
    fn clear_safety(&self, py: Python<'_>, reason: String) -> PyResult<Told> {
        self.tell(py, Named::Entry("clear_safety"), move |held, _| {
            held.session()?.clear_safety(&reason)?;
            Ok(Vec::new())
        })
    }

    /// Records that the receiving vessel is empty.
    fn vessel_emptied(&self, py: Python<'_>) -> PyResult<Told> {
        self.tell(py, Named::Entry("vessel_emptied"), |held, _| {
            held.session()?.vessel_emptied()?;
            Ok(Vec::new())
        })
    }
}
