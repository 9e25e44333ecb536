//! A run of the model at constant speed from lines at rest. There is no dose.

use std::array;

use pump_model::{
    DEFAULT_TOLERANCE, Friction, Leg, LineState, ModelError, Parameter, Pump, RollerCentric, SteadyState,
};
use serde::Serialize;
use thiserror::Error;

use crate::simulation::{EqualTimes, Integration, Method, Waveform};
use crate::words::{words, words_of_reports};

/// Largest number of samples of a run.
const MAX_SAMPLES: f64 = 1e9;

/// The method that the user asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum AskedMethod {
    /// Exact solution where there is one, else the integrator.
    #[default]
    Auto,
    /// Exact solution.
    Exact,
    /// Integrator for any model and line.
    Rodas5p,
    /// Integrator for lines with a constant R.
    Radau,
}

words!(AskedMethod { Auto = "auto", Exact = "exact", Rodas5p = "rodas5p", Radau = "radau" });

/// Model of the rollers that a run computes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ModelName {
    /// Flow-centric model: flows at the rollers drive the lines.
    #[default]
    FlowCentric,
    /// Roller-centric model (experimental): every roller is a valve, every segment between two rollers a chamber.
    RollerCentric,
}

words_of_reports!(ModelName { FlowCentric = "flow-centric", RollerCentric = "roller-centric" });

/// A method that does not fit the model or the lines.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[non_exhaustive]
pub enum MethodError {
    /// The roller-centric model has no exact solution.
    #[error(
        "the roller-centric model is not linear and has no exact solution; allowed: method auto or rodas5p"
    )]
    ExactRollerCentric,
    /// The friction of a hose has no exact solution.
    #[error(
        "the friction of a hose grows with the flow and has no exact solution; allowed: method auto or \
         rodas5p, or a pump file that gives the lines' R, C and L in place of their hoses"
    )]
    ExactFriction,
    /// The roller-centric model is not linear.
    #[error(
        "the roller-centric model is not linear, as method radau needs it; allowed: method auto or rodas5p"
    )]
    RadauRollerCentric,
    /// The friction of a hose is not linear.
    #[error(
        "the friction of a hose grows with the flow, and method radau needs lines with a constant R; allowed: method \
         auto or rodas5p, or a pump file that gives the lines' R, C and L in place of their hoses"
    )]
    RadauFriction,
    /// The exact solution takes no tolerance.
    #[error(
        "tolerance is {tolerance}, but the exact solution has none; allowed: none, or method \"rodas5p\" or \
         \"radau\""
    )]
    ToleranceOfExact {
        /// Tolerance that was given.
        tolerance: f64,
    },
}

/// Chooses the method for a model and for the frictions of the hoses of inlet and outlet.
///
/// Without a `tolerance` the integrator takes [`DEFAULT_TOLERANCE`].
///
/// # Errors
/// Returns the [`MethodError`] of a method that the model or the lines do not have, or of a tolerance for an exact
/// solution.
pub fn choose_method(
    asked: AskedMethod,
    roller_centric: Option<RollerCentric>,
    frictions: [Option<Friction>; 2],
    tolerance: Option<f64>,
) -> Result<Method, MethodError> {
    let is_linear = roller_centric.is_none() && frictions == [None; 2];
    match asked {
        AskedMethod::Exact if roller_centric.is_some() => Err(MethodError::ExactRollerCentric),
        AskedMethod::Exact if !is_linear => Err(MethodError::ExactFriction),
        AskedMethod::Radau if roller_centric.is_some() => Err(MethodError::RadauRollerCentric),
        AskedMethod::Radau if !is_linear => Err(MethodError::RadauFriction),
        AskedMethod::Radau => Ok(Method::Radau { tolerance: tolerance.unwrap_or(DEFAULT_TOLERANCE) }),
        AskedMethod::Exact | AskedMethod::Auto if is_linear => match tolerance {
            None => Ok(Method::Exact),
            Some(tolerance) => Err(MethodError::ToleranceOfExact { tolerance }),
        },
        _ => {
            let tolerance = tolerance.unwrap_or(DEFAULT_TOLERANCE);
            Ok(Method::Rodas5p(Integration { tolerance, frictions, roller_centric }))
        }
    }
}

/// A run of the model at constant speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Simulation {
    /// Speed, in rad/s. Not zero; negative in reverse.
    pub speed_rad_s: f64,
    /// Duration, in s, positive.
    pub duration_s: f64,
    /// Time between samples, in s, positive.
    pub dt_s: f64,
    /// Method that computes the pressures.
    pub method: Method,
}

impl Simulation {
    /// Makes a run by the exact solution.
    pub fn new(speed_rad_s: f64, duration_s: f64, dt_s: f64) -> Self {
        Self { speed_rad_s, duration_s, dt_s, method: Method::Exact }
    }

    /// Refuses a run whose speed, duration or sampling is out of range.
    ///
    /// # Errors
    /// [`ModelError::OutOfRange`] with the parameter, its value and the allowed range.
    pub fn validate(&self) -> Result<(), ModelError> {
        let out = |parameter, value, allowed: &'static str| {
            Err(ModelError::OutOfRange { parameter, value, allowed: allowed.into() })
        };
        if !(1e-6..=1e4).contains(&self.speed_rad_s.abs()) {
            return out(Parameter::Speed, self.speed_rad_s, "1e-6 to 1e4 either way");
        }
        if !(self.duration_s > 0.0 && self.duration_s <= 1e7) {
            return out(Parameter::Duration, self.duration_s, "more than 0, 1e7 at most");
        }
        if !(self.dt_s > 0.0 && self.dt_s <= self.duration_s) {
            return out(Parameter::SampleInterval, self.dt_s, "more than 0, no more than the duration");
        }
        if self.duration_s / self.dt_s > MAX_SAMPLES {
            return out(Parameter::Samples, self.duration_s / self.dt_s, "1e9 at most; use a longer dt");
        }
        Ok(())
    }

    /// Returns the periodic steady state to which the run tends.
    ///
    /// # Errors
    /// Returns the [`ModelError`] of a run that [`Simulation::validate`] refuses, or of the steady state.
    pub fn steady_state(&self, pump: &Pump) -> Result<SteadyState, ModelError> {
        self.validate()?;
        self.method.steady_state(pump, self.speed_rad_s)
    }

    /// Returns the number of intervals. Samples are at n dt and include the end if the duration is a multiple
    /// of dt.
    pub fn intervals(&self) -> u64 {
        // A duration of 10 s and a dt of 1 ms give 10,000 intervals, even if their quotient rounds below it.
        let quotient = self.duration_s / self.dt_s;
        let nearest = quotient.round();
        if (quotient - nearest).abs() <= 1e-9 * nearest { nearest as u64 } else { quotient as u64 }
    }

    /// Returns the samples in order of time.
    ///
    /// # Errors
    /// Returns the [`ModelError`] of a run that [`Simulation::validate`] refuses, or of the integrator.
    pub fn samples<'a>(
        &self,
        pump: &'a Pump,
    ) -> Result<Waveform<'a, array::IntoIter<Leg, 1>, EqualTimes>, ModelError> {
        self.validate()?;
        let legs = [Leg::constant_speed(0.0, self.speed_rad_s)];
        Waveform::every(pump, legs, self.method, (self.dt_s, self.intervals()), [LineState::AT_REST; 2])
    }
}

/// Statistics of the periodic steady state, named as in JSON and Python.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[non_exhaustive]
pub struct SteadyReport {
    /// Smallest inlet pressure, in kPa absolute.
    pub inlet_min_kpa: f64,
    /// Largest inlet pressure, in kPa absolute.
    pub inlet_max_kpa: f64,
    /// Mean inlet pressure, in kPa absolute.
    pub inlet_mean_kpa: f64,
    /// Smallest outlet pressure, in kPa absolute.
    pub outlet_min_kpa: f64,
    /// Largest outlet pressure, in kPa absolute.
    pub outlet_max_kpa: f64,
    /// Mean outlet pressure, in kPa absolute.
    pub outlet_mean_kpa: f64,
    /// Mean flow, in mL/s.
    pub mean_flow_ml_s: f64,
    /// Ripple of the flow at the outlet rollers, (largest - smallest) / mean.
    pub ripple_peak_to_peak: f64,
    /// Ripple of the flow at the outlet rollers, standard deviation / mean.
    pub ripple_rms: f64,
}

impl From<SteadyState> for SteadyReport {
    fn from(steady: SteadyState) -> Self {
        Self {
            inlet_min_kpa: steady.inlet.min_kpa,
            inlet_max_kpa: steady.inlet.max_kpa,
            inlet_mean_kpa: steady.inlet_mean_kpa,
            outlet_min_kpa: steady.outlet.min_kpa,
            outlet_max_kpa: steady.outlet.max_kpa,
            outlet_mean_kpa: steady.outlet_mean_kpa,
            mean_flow_ml_s: steady.mean_flow_ml_s,
            ripple_peak_to_peak: steady.ripple.peak_to_peak,
            ripple_rms: steady.ripple.rms,
        }
    }
}
