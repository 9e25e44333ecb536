//! A pump with the limits and the calibration that its doses keep to.

use pump_ctl::plan::Limits as CtlLimits;
use pyo3::prelude::*;

use super::limits::Limits;
use crate::calibration::Calibration;
use crate::pump::{Pump, pump_given};
use crate::python::errors;

/// Plans doses of a pump within its limits.
///
/// Parameters
/// ----------
/// pump : Pump
///     Pump that doses.
/// limits : Limits, optional
///     Pressure limits that replace the pump file's.
/// calibration : Calibration, optional
///     Calibration of the volume. Without one, volume and uncertainty are the model's.
///
/// Raises
/// ------
/// ValueError
///     If a limit is outside its range.
///
/// Examples
/// --------
/// >>> import pumpmodel as pm
/// >>> plan = pm.Doser(pm.Pump.three_roller()).plan("25mL", rate="10 mL/s")
/// >>> plan.steps
/// 15480
#[pyclass(frozen, get_all, module = "pumpmodel")]
pub(crate) struct Doser {
    /// Pump that doses.
    pub(crate) pump: Py<Pump>,
    /// Pressure limits that replace the pump file's.
    pub(crate) limits: Limits,
    /// Calibration of the volume, or None.
    pub(crate) calibration: Option<Py<Calibration>>,
}

#[pymethods]
impl Doser {
    #[new]
    #[pyo3(signature = (pump, limits=None, calibration=None))]
    fn new(
        #[pyo3(from_py_with = pump_given)] pump: Py<Pump>,
        limits: Option<Py<Limits>>,
        calibration: Option<Py<Calibration>>,
    ) -> PyResult<Self> {
        let limits = limits.map_or(Limits::default(), |limits| *limits.get());
        let doser = Self { pump, limits, calibration };
        doser.ctl_limits().validate().map_err(errors::plan)?;
        Ok(doser)
    }

    pub(crate) fn __eq__(&self, other: &Self) -> bool {
        let calibrations = [self, other].map(|doser| doser.calibration.as_ref().map(Py::get));
        self.limits == other.limits
            && self.pump.get() == other.pump.get()
            && calibrations[0] == calibrations[1]
    }

    pub(crate) fn __hash__(&self, py: Python<'_>) -> PyResult<isize> {
        let parts = (self.pump.get().__hash__(py)?, self.limits.__hash__(py)?);
        parts.into_pyobject(py)?.into_any().hash()
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let calibration = match &self.calibration {
            Some(calibration) => format!(", {}", calibration.bind(py).repr()?),
            None => String::new(),
        };
        Ok(format!("Doser({}, {}{calibration})", self.pump.bind(py).repr()?, self.limits.__repr__()))
    }

    #[allow(clippy::type_complexity, reason = "a class and its arguments, for pickle")]
    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> (Bound<'py, PyAny>, (Py<Pump>, Limits, Option<Py<Calibration>>)) {
        let calibration = self.calibration.as_ref().map(|calibration| calibration.clone_ref(py));
        (py.get_type::<Self>().into_any(), (self.pump.clone_ref(py), self.limits, calibration))
    }
}

impl Doser {
    /// Returns the limits of the pump file, with the pressures given here in place of its `[limits]`.
    fn ctl_limits(&self) -> CtlLimits {
        self.pump.get().file.limits_with(self.limits.pressures())
    }
}
