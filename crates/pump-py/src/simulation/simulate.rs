//! A pump over time: at constant speed, at speeds between knots, or at a speed that is a function of time.

use pump_bench::simulation::{AskedMethod, Course, Method, ModelName, Waveform, choose_method, interval_s};
use pump_model::{LineState, Pump as Model, RollerCentric};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyString;

use super::motion::{Asked, Motion, Times};
use super::run::Run;
use super::sensitivity::{sensitivity as derivatives, starts};
use crate::argument::{Argument, choice, flag, optional, word};
use crate::pump::Pump;
use crate::python::errors::{self, value};

/// Largest pressure, kPa, and flow, mL/s, of a line at the start, either way.
const MAX_STATE: f64 = 1e6;

/// Names of states at the start.
pub(crate) const INITIALS: [&str; 2] = ["rest", "steady"];

#[pymethods]
impl Pump {
    /// Run the model over time. Other Python threads run meanwhile, except while a speed that is a function is asked.
    ///
    /// Parameters
    /// ----------
    /// speed_rpm : float, array_like or callable
    ///     Speed of the pump head, r/min; negative in reverse. One number is a constant speed, not zero, from time 0
    ///     on. An array of shape (n,) has the speeds at the times `time_s`, and the speed is a straight line from
    ///     each to the next. A callable takes the time, s, from 0 on and returns the speed. Straight pieces follow
    ///     it to within 1e-6 of 1 rad/s + the speed. Jumps are found to 1e-9 of the time; a pulse that is shorter
    ///     than the samples may be missed.
    /// speed_rad_s : float, array_like or callable
    ///     Speed of the pump head, rad/s. Give exactly one of `speed_rpm` and `speed_rad_s`.
    /// duration_s : float, optional
    ///     Duration, s, up to 1e7, for samples at equal intervals from time 0 on.
    /// dt_s : float, optional
    ///     Time between samples, s; by default 1e-3. Samples stand at `arange(n + 1)*dt_s`, both ends included.
    /// time_s : array_like, optional
    ///     Times of the samples in place of `duration_s`, s, rising, from 0 to 1e7, shape (n,). With an array of
    ///     speeds these are the times of the speeds, up to 1e7 either way, and the motion starts at the first.
    /// output_time_s : array_like, optional
    ///     Times of the samples with an array of speeds, s, rising, within `time_s`, shape (m,); by default `time_s`.
    /// start_angle_rad : float
    ///     Angle of the pump head at the start, rad, unwrapped, up to 1e9 either way.
    /// model : {"flow-centric", "roller-centric"}
    ///     "flow-centric": the flows at the rollers drive the lines. "roller-centric": every roller is a valve, and
    ///     every segment of tube between two rollers is a chamber. The roller-centric model is experimental, a
    ///     reconstruction whose parameters are fitted to summary numbers or guessed.
    /// method : {"auto", "exact", "rodas5p", "radau"}
    ///     "exact" is the exact solution, "rodas5p" the implicit integrator for any model. "radau" is the integrator
    ///     for lines with a constant resistance, in a quarter of the steps. "auto" takes the exact solution, except for
    ///     the roller-centric model and for lines that are hoses, whose friction grows with the flow: "rodas5p".
    /// initial : {"rest", "steady"} or LineStates
    ///     State at the start. "rest": the lines have the pressures of their reservoirs and no flow. "steady": the
    ///     pump has turned at the speed of the start for long. `LineStates`: pressures and flows of both lines, such
    ///     as `end_state` of an earlier run. The roller-centric model starts from rest.
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
    /// sensitivity : bool
    ///     True for the derivatives of pressures and delivered volume by R, C and L of the lines, the start angle and
    ///     the roller volume too, as `run.sensitivity`. They are exact, so `method` must not be the integrator. States
    ///     that are given depend on none of these; those of "steady" do.
    ///
    /// Returns
    /// -------
    /// Run
    ///     Flows and pressures over time.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If an argument is not allowed, or if the speed varies and the pump's volumes depend on the speed.
    /// PumpError
    ///     If the solver fails on the way.
    /// MemoryError
    ///     If there is no room for the samples.
    ///
    /// Warns
    /// -----
    /// UserWarning
    ///     If a pressure is below 0 kPa absolute, where every liquid cavitates and the model has no meaning: anywhere
    ///     from the start to the last sample, also between two samples. The roller-centric model is judged by its
    ///     samples.
    ///
    /// Examples
    /// --------
    /// >>> import pumpmodel as pm
    /// >>> pump = pm.Pump.three_roller()
    /// >>> steady = pump.simulate(speed_rpm=100, duration_s=0.6, initial="steady", start_angle_rad=0.5)
    /// >>> ramp = pump.simulate(
    /// ...     speed_rpm=[100, 0, 0], time_s=[0, 0.5, 2], output_time_s=[0, 0.25, 0.5, 2], initial=steady.end_state,
    /// ...     start_angle_rad=steady.angle_rad[-1],
    /// ... )
    /// >>> float(ramp.speed_rad_s[-1])
    /// 0.0
    #[allow(clippy::too_many_arguments, reason = "keywords of one Python call")]
    #[pyo3(signature = (
        *, speed_rpm=None, speed_rad_s=None, duration_s=None, dt_s=None, time_s=None, output_time_s=None,
        start_angle_rad=None, model="flow-centric", method="auto", initial=None, tolerance=None, segment_scale=None,
        distensibility_per_kpa=None, valve_resistance_kpa_s_ml=None, closure_rad=None, sensitivity=None
    ), text_signature = "($self, *, speed_rpm=None, speed_rad_s=None, duration_s=None, dt_s=None, time_s=None, \
        output_time_s=None, start_angle_rad=0.0, model=\"flow-centric\", method=\"auto\", initial=\"rest\", \
        tolerance=None, segment_scale=None, distensibility_per_kpa=None, valve_resistance_kpa_s_ml=None, \
        closure_rad=None, sensitivity=False)")]
    fn simulate<'py>(
        &self,
        py: Python<'py>,
        speed_rpm: Argument<'_, 'py>,
        speed_rad_s: Argument<'_, 'py>,
        duration_s: Argument<'_, 'py>,
        dt_s: Argument<'_, 'py>,
        time_s: Argument<'_, 'py>,
        output_time_s: Argument<'_, 'py>,
        start_angle_rad: Argument<'_, 'py>,
        model: &str,
        method: &str,
        initial: Argument<'_, 'py>,
        tolerance: Argument<'_, 'py>,
        segment_scale: Argument<'_, 'py>,
        distensibility_per_kpa: Argument<'_, 'py>,
        valve_resistance_kpa_s_ml: Argument<'_, 'py>,
        closure_rad: Argument<'_, 'py>,
        sensitivity: Argument<'_, 'py>,
    ) -> PyResult<Run> {
        let sensitivity = flag("sensitivity", sensitivity)?;
        let (duration_s, dt_s) = (optional("duration_s", duration_s)?, optional("dt_s", dt_s)?);
        let start_angle_rad = optional("start_angle_rad", start_angle_rad)?.unwrap_or_default();
        let tolerance = optional("tolerance", tolerance)?;
        let is_roller_centric = word("model", model, ModelName::ALL)? == ModelName::RollerCentric;
        let asked = word("method", method, AskedMethod::ALL)?;
        let optional = |name, given| Ok::<_, PyErr>((name, optional(name, given)?));
        let given = [
            optional("segment_scale", segment_scale)?,
            optional("distensibility_per_kpa", distensibility_per_kpa)?,
            optional("valve_resistance_kpa_s_ml", valve_resistance_kpa_s_ml)?,
            optional("closure_rad", closure_rad)?,
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
        if sensitivity && method != Method::Exact {
            return Err(value(
                "sensitivity is True, but the integrator has no derivatives; allowed: the exact solution of the \
                 flow-centric model, with lines that are given by their resistance",
            ));
        }
        let motion = Motion::of(&Asked {
            speed_rpm,
            speed_rad_s,
            duration_s,
            dt_s,
            time_s,
            output_time_s,
            start_angle_rad,
        })?;
        let model = match (roller_centric, motion.constant_rad_s) {
            // The roller-centric model has a volume against speed of its own.
            (Some(_), _) => *self.model(),
            (None, Some(rad_s)) => self.by_speed.at(rad_s).map_err(errors::displacement)?,
            (None, None) if self.by_speed.law().is_some() => {
                return Err(value(
                    "the speed varies, but the volumes of this pump depend on the speed and are known for constant \
                     speeds; give one speed, or a pump without [speed_law]",
                ));
            }
            (None, None) => *self.by_speed.base(),
        };
        let states = states(py, initial, &method, &model, (motion.first_rad_s(), start_angle_rad))?;
        let run = computed(py, &model, method, &motion, states)?;
        if !sensitivity {
            return Ok(run);
        }
        let is_steady = is_steady(initial);
        let starts = py.detach(|| starts(&model, &motion, states, is_steady))?;
        let found = derivatives(py, &model, &motion, starts, &run)?;
        Ok(run.with_sensitivity(found.unbind()))
    }
}

/// Returns true if the state at the start is the word for the steady one.
fn is_steady(initial: Argument<'_, '_>) -> bool {
    let [_, steady] = INITIALS;
    initial.is_some_and(|initial| initial.extract().is_ok_and(|word: &str| word == steady))
}

/// Computes the samples of a motion, and warns of pressures below 0.
fn computed(
    py: Python<'_>,
    model: &Model,
    method: Method,
    motion: &Motion,
    states: [LineState; 2],
) -> PyResult<Run> {
    let legs = motion.legs.iter().copied();
    let run = match &motion.times {
        Times::Every { dt_s, intervals } => {
            let samples = Waveform::every(model, legs.clone(), method, (*dt_s, *intervals), states);
            Run::collect(py, intervals + 1, samples.map_err(errors::model)?)?
        }
        Times::At(times_s) => {
            let samples = Waveform::starting(model, legs.clone(), method, times_s.iter().copied(), states);
            let samples = samples.map_err(errors::model)?;
            let samples = match interval_s(times_s) {
                Some(dt_s) => samples.at_equal_intervals(dt_s),
                None => samples,
            };
            Run::collect(py, times_s.len() as u64, samples)?
        }
    };
    let course = Course { pump: model, method, states, end_s: motion.last_s() };
    run.warn_of_cavitation(py, course, &legs)?;
    Ok(run)
}

/// Reads the states of the lines of inlet and outlet at the start, where the rotor has a speed and an angle.
fn states(
    py: Python<'_>,
    initial: Argument<'_, '_>,
    method: &Method,
    model: &Model,
    (speed_rad_s, angle_rad): (f64, f64),
) -> PyResult<[LineState; 2]> {
    let rest = [LineState::AT_REST; 2];
    let Some(initial) = initial else { return Ok(rest) };
    if let Ok(word) = initial.cast::<PyString>() {
        let [at_rest, steady] = INITIALS;
        if !choice("initial", word.to_str()?, &[(at_rest, false), (steady, true)])? {
            return Ok(rest);
        }
        if speed_rad_s == 0.0 {
            return Err(value(
                "initial is 'steady', but the speed at the start is 0; allowed: 'rest', or a speed other than 0",
            ));
        }
        return py.detach(|| method.periodic_states(model, speed_rad_s, angle_rad)).map_err(errors::model);
    }
    let Ok([inlet_kpa, inlet_line_ml_s, outlet_kpa, outlet_line_ml_s]) = initial.extract::<[f64; 4]>() else {
        return Err(PyTypeError::new_err(format!(
            "initial must be 'rest', 'steady' or a LineStates of four numbers, not {}",
            initial.get_type().name()?
        )));
    };
    let given = [
        ("inlet_kpa", inlet_kpa),
        ("inlet_line_ml_s", inlet_line_ml_s),
        ("outlet_kpa", outlet_kpa),
        ("outlet_line_ml_s", outlet_line_ml_s),
    ];
    if let Some((name, number)) = given.iter().find(|(_, number)| !(-MAX_STATE..=MAX_STATE).contains(number))
    {
        return Err(value(format_args!(
            "{name} of initial is {number}; allowed: a finite number, up to {MAX_STATE:e} either way"
        )));
    }
    let state = |kpa: f64, flow_ml_s, reservoir_kpa: f64| LineState {
        above_reservoir_kpa: kpa - reservoir_kpa,
        flow_ml_s,
    };
    Ok([
        state(inlet_kpa, inlet_line_ml_s, model.inlet().reservoir_kpa),
        state(outlet_kpa, outlet_line_ml_s, model.outlet().reservoir_kpa),
    ])
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
