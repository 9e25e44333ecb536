//! A pump at constant speed: from rest, and once start-up is forgotten.

use pump_bench::simulation::{AskedMethod, Simulation, choose_method};
use pump_model::RollerCentric;
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
    /// model : {"flow-centric", "roller-centric"}
    ///     Flows at the rollers that drive the lines, or every roller a valve and every segment of tube between two a
    ///     chamber. The second is experimental: a reconstruction whose parameters are fitted to summary numbers or guessed.
    /// method : {"auto", "exact", "rodas5p"}
    ///     The exact solution or the implicit integrator. "auto" is the exact one but for the roller-centric model and for
    ///     lines that are hoses, whose friction grows with the flow.
    /// initial : {"rest"}
    ///     Lines at rest at time 0: pressures of the reservoirs, no flow.
    /// tolerance : float, optional
    ///     Of the integrator: error allowed in a step, relative to 1 kPa plus the pressure above the reservoir's; 1e-13
    ///     to 0.1. The default of 1e-5 keeps the pressures of the built-in pumps within 1e-4 kPa (1e-3 roller-centric).
    /// segment_scale : float, optional
    ///     Roller-centric, as all that follow: volume between two rollers over that of the round tube, 0.5 to 2; 0.953.
    /// distensibility_per_kpa : float, optional
    ///     How much more a segment holds for more pressure, 1/kPa, 1e-9 to 1; 2.05e-3.
    /// valve_resistance_kpa_s_ml : float, optional
    ///     What a roller that only just touches the tube resists, kPa s/mL, 1e-9 to 1e3; 1e-3.
    /// closure_rad : float, optional
    ///     Where an engaging roller has closed the tube, rad after first contact; that of the pump's dimensions.
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
        initial="rest", tolerance=None, segment_scale=None, distensibility_per_kpa=None,
        valve_resistance_kpa_s_ml=None, closure_rad=None
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
        segment_scale: Option<f64>,
        distensibility_per_kpa: Option<f64>,
        valve_resistance_kpa_s_ml: Option<f64>,
        closure_rad: Option<f64>,
    ) -> PyResult<Run> {
        one_of("model", model, &["flow-centric", "roller-centric"])?;
        one_of("method", method, &["auto", "exact", "rodas5p"])?;
        one_of("initial", initial, &["rest"])?;
        let given = [
            ("segment_scale", segment_scale),
            ("distensibility_per_kpa", distensibility_per_kpa),
            ("valve_resistance_kpa_s_ml", valve_resistance_kpa_s_ml),
            ("closure_rad", closure_rad),
        ];
        let roller_centric = if model == "roller-centric" {
            Some(self.roller_centric(given.map(|(_, value)| value))?)
        } else if let Some((name, Some(given))) = given.into_iter().find(|(_, value)| value.is_some()) {
            return Err(value(format_args!(
                "{name} is {given}, but model \"{model}\" has none; allowed: none, or model \"roller-centric\""
            )));
        } else {
            None
        };
        let asked = match method {
            "exact" => AskedMethod::Exact,
            "rodas5p" => AskedMethod::Rodas5p,
            _ => AskedMethod::Auto,
        };
        let frictions = self.file.frictions().map_err(errors::model)?;
        let method = choose_method(asked, roller_centric, frictions, tolerance).map_err(value)?;
        let simulation = Simulation {
            method,
            ..Simulation::new(speed::speed_rad_s(speed_rpm, speed_rad_s)?, duration_s, dt_s)
        };
        // The roller-centric model has a volume against speed of its own.
        let model = match roller_centric {
            Some(_) => self.model,
            None => self.model_at(simulation.speed_rad_s).map_err(errors::speed_law)?,
        };
        let samples = simulation.samples(&model).map_err(errors::model)?;
        Run::collect(py, simulation.intervals() + 1, samples)
    }

    /// Periodic steady state at constant speed, start-up forgotten. Other threads run meanwhile. A line that is a hose
    /// has its resistance at the pump's default rate; `simulate` follows its friction at every flow.
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

impl Pump {
    /// The parameters of the roller-centric model: those given (scale, distensibility, valve resistance, closure), and the
    /// pump's own.
    fn roller_centric(&self, given: [Option<f64>; 4]) -> PyResult<RollerCentric> {
        let [scale, distensibility_per_kpa, valve_resistance_kpa_s_ml, closure_rad] = given;
        let ambient_kpa = self.file.ambient.pressure_kpa;
        // Dimensions from which no closure follows do no harm where it is given.
        let own = match closure_rad {
            Some(closure_rad) => RollerCentric { closure_rad, ambient_kpa, ..RollerCentric::PUBLISHED },
            None => RollerCentric::of(&self.model, ambient_kpa).map_err(errors::model)?,
        };
        Ok(RollerCentric {
            scale: scale.unwrap_or(own.scale),
            distensibility_per_kpa: distensibility_per_kpa.unwrap_or(own.distensibility_per_kpa),
            valve_resistance_kpa_s_ml: valve_resistance_kpa_s_ml.unwrap_or(own.valve_resistance_kpa_s_ml),
            ..own
        })
    }
}
