//! Computations behind `pumpmodel.Fluid` and `pumpmodel.Hose`.

use pump_model::{Fluid, Hose, ModelError};
use pyo3::prelude::*;

use super::line::Line;
use crate::argument::{Floats, number};
use crate::python::errors;

/// Largest flow, mL/s, whose pressure drop is computed.
const MAX_FLOW_ML_S: f64 = 1e6;

/// Density (kg/m³), viscosity (mPa s), bulk modulus (MPa), vapour pressure (kPa).
type FluidNumbers = (f64, f64, f64, Option<f64>);
/// Bore radius, outer radius, length (mm), modulus (MPa), Poisson ratio, minor loss.
type HoseNumbers = (f64, f64, f64, f64, f64, f64);

fn fluid_of(numbers: FluidNumbers) -> Result<Fluid, ModelError> {
    let (density_kg_m3, viscosity_mpa_s, bulk_modulus_mpa, vapour_kpa) = numbers;
    let fluid = Fluid { density_kg_m3, viscosity_mpa_s, bulk_modulus_mpa, vapour_kpa };
    fluid.validate()?;
    Ok(fluid)
}

fn hose_of(numbers: HoseNumbers) -> Result<Hose, ModelError> {
    let (bore_radius_mm, outer_radius_mm, length_mm, modulus_mpa, poisson_ratio, minor_loss) = numbers;
    let hose = Hose { bore_radius_mm, outer_radius_mm, length_mm, modulus_mpa, poisson_ratio, minor_loss };
    hose.validate()?;
    Ok(hose)
}

/// Refuses properties that no fluid has.
#[pyfunction]
pub(crate) fn _fluid_check(fluid: FluidNumbers) -> PyResult<()> {
    fluid_of(fluid).map(drop).map_err(errors::model)
}

/// Returns the properties of water at a temperature, degC.
#[pyfunction]
pub(crate) fn _fluid_water(temperature_degc: &Bound<'_, PyAny>) -> PyResult<FluidNumbers> {
    let water = Fluid::water(number("temperature_degc", temperature_degc)?).map_err(errors::model)?;
    Ok((water.density_kg_m3, water.viscosity_mpa_s, water.bulk_modulus_mpa, water.vapour_kpa))
}

/// Returns the volume of a hose's bore, mL. Refuses dimensions that no hose has.
#[pyfunction]
pub(crate) fn _hose_volume(hose: HoseNumbers) -> PyResult<f64> {
    Ok(hose_of(hose).map_err(errors::model)?.volume_ml())
}

/// Returns the linear line of a hose.
#[pyfunction]
pub(crate) fn _hose_line(
    hose: HoseNumbers,
    fluid: FluidNumbers,
    reservoir_kpa: &Bound<'_, PyAny>,
    flow_ml_s: &Bound<'_, PyAny>,
) -> PyResult<Line> {
    let (reservoir_kpa, flow_ml_s) =
        (number("reservoir_kpa", reservoir_kpa)?, number("flow_ml_s", flow_ml_s)?);
    let line = hose_of(hose).and_then(|hose| hose.line(&fluid_of(fluid)?, reservoir_kpa, flow_ml_s));
    line.map(Line).map_err(errors::model)
}

/// Returns the pressure drop at a flow, kPa.
#[pyfunction]
pub(crate) fn _hose_drop<'py>(
    hose: HoseNumbers,
    fluid: FluidNumbers,
    flow_ml_s: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    let friction = hose_of(hose).and_then(|hose| hose.friction(&fluid_of(fluid)?)).map_err(errors::model)?;
    let flows = Floats::read("flow_ml_s", flow_ml_s, MAX_FLOW_ML_S)?;
    let py = flow_ml_s.py();
    flows.map(py, |flow| friction.drop_kpa(flow))?.into_object(py)
}

/// Returns the Reynolds number of a flow.
#[pyfunction]
pub(crate) fn _hose_reynolds<'py>(
    hose: HoseNumbers,
    fluid: FluidNumbers,
    flow_ml_s: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    let friction = hose_of(hose).and_then(|hose| hose.friction(&fluid_of(fluid)?)).map_err(errors::model)?;
    let flows = Floats::read("flow_ml_s", flow_ml_s, MAX_FLOW_ML_S)?;
    let py = flow_ml_s.py();
    flows.map(py, |flow| friction.reynolds(flow))?.into_object(py)
}
