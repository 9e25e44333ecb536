//! Dimensions of a pump as its drawing shows them, and the angles that follow.

use pyo3::prelude::*;

use super::pump::Pump;
use crate::python::errors;

#[pymethods]
impl Pump {
    /// Inner radius of the tube r_i, mm.
    #[getter]
    fn bore_radius_mm(&self) -> f64 {
        self.model().geometry().bore_radius_mm
    }

    /// Outer radius of the tube r_o, mm.
    #[getter]
    fn tube_outer_radius_mm(&self) -> f64 {
        self.model().geometry().tube_outer_radius_mm
    }

    /// Radius of the backplate (raceway) r_b, mm.
    #[getter]
    fn backplate_radius_mm(&self) -> f64 {
        self.model().geometry().backplate_radius_mm
    }

    /// Contact angle beta, rad: the backplate spans pi + 2 beta.
    #[getter]
    fn contact_angle_rad(&self) -> f64 {
        self.model().geometry().contact_angle_rad
    }

    /// Radius of a roller r_roller, mm.
    #[getter]
    fn roller_radius_mm(&self) -> f64 {
        self.model().geometry().roller_radius_mm
    }

    /// Distance from the shaft to a roller's axis r_offset, mm.
    #[getter]
    fn roller_offset_mm(&self) -> f64 {
        self.model().geometry().roller_offset_mm
    }

    /// Depth by which neighbouring rollers overlap in space, mm. None if they do not.
    ///
    /// The model computes a head whose rollers overlap, but nobody can build it.
    #[getter]
    fn rollers_overlap_mm(&self) -> Option<f64> {
        self.model().geometry().rollers_overlap_mm()
    }

    /// Inlet phase psi, rad: the inlet's pulse begins this far behind the outlet's.
    ///
    /// Between the two a roller stays fully engaged for `2*pi - engagement_rad - inlet_phase_rad`.
    #[getter]
    fn inlet_phase_rad(&self) -> PyResult<f64> {
        self.model().geometry().inlet_phase_rad(self.model().roller_volume()).map_err(errors::model)
    }
}
