//! Former names of a pump's methods, which had no unit. They warn.

use pyo3::prelude::*;

use super::pump::Pump;
use crate::argument::Argument;
use crate::python::renamed;

#[pymethods]
impl Pump {
    /// Deprecated name of `average_flow_ml_s`.
    #[pyo3(signature = (*, speed_rpm=None, speed_rad_s=None))]
    fn average_flow<'py>(
        &self,
        py: Python<'py>,
        speed_rpm: Argument<'_, 'py>,
        speed_rad_s: Argument<'_, 'py>,
    ) -> PyResult<Bound<'py, PyAny>> {
        renamed(py, "Pump.average_flow", "Pump.average_flow_ml_s")?;
        self.average_flow_ml_s(py, speed_rpm, speed_rad_s)
    }

    /// Deprecated name of `speed_for_flow_rpm`.
    #[pyo3(signature = (*, flow_ml_s))]
    fn speed_for_flow<'py>(&self, flow_ml_s: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        renamed(flow_ml_s.py(), "Pump.speed_for_flow", "Pump.speed_for_flow_rpm")?;
        self.speed_for_flow_rpm(flow_ml_s)
    }

    /// Deprecated name of `outlet_volume_ml`.
    fn outlet_volume<'py>(&self, angle_rad: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        renamed(angle_rad.py(), "Pump.outlet_volume", "Pump.outlet_volume_ml")?;
        self.outlet_volume_ml(angle_rad)
    }

    /// Deprecated name of `outlet_flow_ml_rad`.
    fn outlet_flow_per_rad<'py>(&self, angle_rad: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        renamed(angle_rad.py(), "Pump.outlet_flow_per_rad", "Pump.outlet_flow_ml_rad")?;
        self.outlet_flow_ml_rad(angle_rad)
    }

    /// Deprecated name of `inlet_volume_ml`.
    fn inlet_volume<'py>(&self, angle_rad: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        renamed(angle_rad.py(), "Pump.inlet_volume", "Pump.inlet_volume_ml")?;
        self.inlet_volume_ml(angle_rad)
    }

    /// Deprecated name of `inlet_flow_ml_rad`.
    fn inlet_flow_per_rad<'py>(&self, angle_rad: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        renamed(angle_rad.py(), "Pump.inlet_flow_per_rad", "Pump.inlet_flow_ml_rad")?;
        self.inlet_flow_ml_rad(angle_rad)
    }
}
