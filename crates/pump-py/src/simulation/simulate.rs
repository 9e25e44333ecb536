//! A pump at constant speed from rest.

use pump_bench::simulation::{AskedMethod, ModelName, Simulation, choose_method};
use pump_model::RollerCentric;
use pyo3::prelude::*;

use super::run::Run;
use crate::argument::{Argument, choice, speed, word};
use crate::pump::Pump;
use crate::python::errors::{self, value};

/// States at time 0.
pub(crate) const INITIALS: [(&str, ()); 1] = [("rest", ())];

#[pymethods]
impl Pump {
    /// Run the model at constant speed from angle 0. Other Python threads run meanwhile.
    ///
    /// Parameters
    /// ----------
    /// speed_rpm : float
    ///     Speed of the pump head, r/min; negative in reverse; not zero.
    /// speed_rad_s : float
    ///     Speed of the pump head, rad/s. Give exactly one of `speed_rpm` and `speed_rad_s`.
    /// duration_s : float
    ///     Duration, s, up to 1e7.
    /// dt_s : float
    ///     Time between samples, s. Samples stand at `arange(n + 1)*dt_s`, both ends included.
    /// model : {"flow-centric", "roller-centric"}
    ///     "flow-centric": the flows at the rollers drive the lines. "roller-centric": every roller is a valve, and
    ///     every segment of tube between two rollers is a chamber. The roller-centric model is experimental, a
    ///     reconstruction whose parameters are fitted to summary numbers or guessed.
    /// method : {"auto", "exact", "rodas5p"}
    ///     "exact" is the exact solution, "rodas5p" the implicit integrator. "auto" takes the exact solution, except
    ///     for the roller-centric model and for lines that are hoses, whose friction grows with the flow.
    /// initial : {"rest"}
    ///     State at time 0. "rest": the lines have the pressures of their reservoirs and no flow.
    /// tolerance : float, optional
    ///     Error that the integrator allows in a step, relative to 1 kPa plus the pressure above the reservoir's; 1e-13
    ///     to 0.1. The default of 1e-5 keeps the pressures of the built-in pumps within 1e-4 kPa (1e-3 roller-centric).
    /// segment_scale : float, optional
    ///     Roller-centric: volume between two rollers over the volume of the round tube, 0.5 to 2; by default 0.953.
    /// distensibility_per_kpa : float, optional
    ///     Roller-centric: relative growth of a segment's volume with pressure, 1/kPa, 1e-9 to 1; by default 2.05e-3.
    /// valve_resistance_kpa_s_ml : float, optional
    ///     Roller-centric: resistance of a roller that only just touches the tube, kPa s/mL, 1e-9 to 1e3; by default
    ///     1e-3.
    /// closure_rad : float, optional
    ///     Roller-centric: angle after first contact at which a roller has closed the tube, rad; by default the angle
    ///     that follows from the pump's dimensions.
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
        let is_roller_centric = word("model", model, ModelName::ALL)? == ModelName::RollerCentric;
        let asked = word("method", method, AskedMethod::ALL)?;
        choice("initial", initial, &INITIALS)?;
        let given = [
            ("segment_scale", segment_scale),
            ("distensibility_per_kpa", distensibility_per_kpa),
            ("valve_resistance_kpa_s_ml", valve_resistance_kpa_s_ml),
            ("closure_rad", closure_rad),
        ];
        let roller_centric = if is_roller_centric {
            Some(self.roller_centric(given.map(|(_, value)| value))?)
        } else if let Some((name, Some(given))) = given.into_iter().find(|(_, value)| value.is_some()) {
            return Err(value(format_args!(
                "{name} is {given}, but model \"{model}\" does not use it; allowed: none, or model \"roller-centric\""
            )));
        } else {
            None
        };
        let frictions = self.file.frictions().map_err(errors::model)?;
        let method = choose_method(asked, roller_centric, frictions, tolerance).map_err(value)?;
        let simulation = Simulation {
            method,
            ..Simulation::new(speed::speed_rad_s(speed_rpm, speed_rad_s)?, duration_s, dt_s)
        };
        // The roller-centric model has a volume against speed of its own.
        let model = match roller_centric {
            Some(_) => *self.model(),
            None => self.by_speed.at(simulation.speed_rad_s).map_err(errors::displacement)?,
        };
        let samples = simulation.samples(&model).map_err(errors::model)?;
        Run::collect(py, simulation.intervals() + 1, samples)
    }
}

impl Pump {
    /// Returns the parameters of the roller-centric model. Scale, distensibility, valve resistance and closure that are
    /// not given come from the pump.
    fn roller_centric(&self, given: [Option<f64>; 4]) -> PyResult<RollerCentric> {
        let [scale, distensibility_per_kpa, valve_resistance_kpa_s_ml, closure_rad] = given;
        let ambient_kpa = self.file.ambient.pressure_kpa;
        // A given closure needs no dimensions from which it could follow.
        let own = match closure_rad {
            Some(closure_rad) => RollerCentric { closure_rad, ambient_kpa, ..RollerCentric::PUBLISHED },
            None => RollerCentric::of(self.model(), ambient_kpa).map_err(errors::model)?,
        };
        Ok(RollerCentric {
            scale: scale.unwrap_or(own.scale),
            distensibility_per_kpa: distensibility_per_kpa.unwrap_or(own.distensibility_per_kpa),
            valve_resistance_kpa_s_ml: valve_resistance_kpa_s_ml.unwrap_or(own.valve_resistance_kpa_s_ml),
            ..own
        })
    }
}
