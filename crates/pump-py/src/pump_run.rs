//! A pump at constant speed: from rest, and once start-up is forgotten.

use pump_dose::Simulation;
use pump_dose::waveform::Method;
use pump_model::DEFAULT_TOLERANCE;
use pyo3::prelude::*;

use crate::errors::{self, value};
use crate::pump::{Pump, one_of};
use crate::run::Run;
use crate::speed::{self, Argument};
use crate::steady::SteadyState;

#[pymethods]
impl Pump {
    /// Runs the model at constant speed from angle 0. Other threads run meanwhile.
    ///
    /// Parameters
    /// ----------
    /// speed_rpm : float
    ///     Speed of the pump head, r/min; negative in reverse; not zero.
    /// speed_rad_s : float
    ///     The same in rad/s; exactly one of both is given.
    /// duration_s : float
    ///     How long, s, up to 1e7.
    /// dt_s : float
    ///     Time between samples, s. They stand at `arange(n + 1)*dt_s`, both ends included.
    /// model : {"flow-centric"}
    ///     Which model.
    /// method : {"auto", "exact", "rodas5p"}
    ///     The exact solution, which "auto" means, or the implicit integrator.
    /// initial : {"rest"}
    ///     Lines at rest at time 0: pressures of the reservoirs, no flow.
    /// tolerance : float, optional
    ///     Of the integrator: error allowed in a step, relative to 1 kPa plus the pressure above the reservoir's; 1e-13
    ///     to 0.1. The default of 1e-5 keeps the pressures of the built-in pumps within 1e-4 kPa.
    ///
    /// Returns
    /// -------
    /// Run
    ///     Flows and pressures over time.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If an argument is not allowed.
    /// PumpError
    ///     If the solver fails on the way.
    /// MemoryError
    ///     If there is no room for the samples.
    #[allow(clippy::too_many_arguments, reason = "keywords of one Python call")]
    #[pyo3(signature = (
        *, speed_rpm=None, speed_rad_s=None, duration_s, dt_s=1e-3, model="flow-centric", method="auto",
        initial="rest", tolerance=None
    ))]
    fn simulate<'py>(
        &self,
        py: Python<'py>,
        speed_rpm: Argument<'_, 'py>,
        speed_rad_s: Argument<'_, 'py>,
        duration_s: f64,
        dt_s: f64,
        model: &str,
        method: &str,
        initial: &str,
        tolerance: Option<f64>,
    ) -> PyResult<Run> {
        one_of("model", model, &["flow-centric"])?;
        one_of("method", method, &["auto", "exact", "rodas5p"])?;
        one_of("initial", initial, &["rest"])?;
        let method = match (method, tolerance) {
            ("rodas5p", tolerance) => Method::Rodas5p { tolerance: tolerance.unwrap_or(DEFAULT_TOLERANCE) },
            (_, None) => Method::Exact,
            (method, Some(tolerance)) => {
                return Err(value(format_args!(
                    "tolerance is {tolerance}, but method \"{method}\" is exact; allowed: none, or method \"rodas5p\""
                )));
            }
        };
        let simulation = Simulation {
            method,
            ..Simulation::new(speed::speed_rad_s(speed_rpm, speed_rad_s)?, duration_s, dt_s)
        };
        let model = self.model_at(simulation.speed_rad_s).map_err(errors::speed_law)?;
        let samples = simulation.samples(&model).map_err(errors::model)?;
        Run::collect(py, simulation.intervals() + 1, samples)
    }

    /// Periodic steady state at constant speed, start-up forgotten. Other threads run meanwhile.
    ///
    /// Parameters
    /// ----------
    /// speed_rpm : float or array_like
    ///     Speed of the pump head, r/min; negative in reverse; not zero.
    /// speed_rad_s : float or array_like
    ///     The same in rad/s; exactly one of both is given.
    ///
    /// Returns
    /// -------
    /// SteadyState
    ///     Its attributes are floats; of arrays, arrays of float64 of the same shape.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a speed is not allowed, or a line without resistance resonates at it.
    /// PumpError
    ///     If the solver fails on the way.
    #[pyo3(signature = (*, speed_rpm=None, speed_rad_s=None))]
    fn steady_state<'py>(
        &self,
        py: Python<'py>,
        speed_rpm: Argument<'_, 'py>,
        speed_rad_s: Argument<'_, 'py>,
    ) -> PyResult<SteadyState> {
        SteadyState::at(py, self, &speed::speeds_rad_s(speed_rpm, speed_rad_s)?)
    }
}
