//! The request of a dose, from Python's keywords.

use pump_bench::record::Purpose;
use pump_bench::{DoseRequest, units};
use pyo3::prelude::*;

use crate::argument::{cruise, finish_named, ramps_named, retracted_ml, text};
use crate::dosing::Limits;
use crate::python::errors::value;

/// Keywords of a dose, read from a dict.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(super) struct AskedDose<'py> {
    volume: Option<Bound<'py, PyAny>>,
    rate: Option<Bound<'py, PyAny>>,
    speed: Option<Bound<'py, PyAny>>,
    within: Option<Bound<'py, PyAny>>,
    smooth: bool,
    finish: Option<String>,
    ramps: Option<String>,
    retract: Option<Bound<'py, PyAny>>,
    start_angle_rad: Option<f64>,
    limits: Option<Py<Limits>>,
}

impl AskedDose<'_> {
    /// Returns the request for a fluid of this density.
    pub(super) fn request(&self, purpose: Purpose, density_kg_m3: f64) -> PyResult<DoseRequest> {
        let volume_ml = match &self.volume {
            Some(volume) => {
                units::amount(text("volume", "25mL", volume)?).map_err(value)?.volume_ml(density_kg_m3)
            }
            // The rest of an unfinished dose: the record has its volume.
            None => 0.0,
        };
        if let Some(angle) = self.start_angle_rad.filter(|angle| !angle.is_finite()) {
            return Err(value(format_args!("start_angle_rad is {angle}; allowed: a finite angle")));
        }
        let limits = self.limits.as_ref().map_or(Limits::default(), |limits| *limits.get());
        Ok(DoseRequest {
            purpose,
            volume_ml,
            cruise: cruise(self.rate.as_ref(), self.speed.as_ref(), self.within.as_ref())?,
            smooth: self.smooth,
            finish: self.finish.as_deref().map(finish_named).transpose()?,
            ramps: self.ramps.as_deref().map(ramps_named).transpose()?,
            start_angle_rad: self.start_angle_rad,
            whole_ml: None,
            retract_ml: retracted_ml(self.retract.as_ref())?,
            pressures: limits.pressures(),
        })
    }
}
