//! A run of the model at constant speed from lines at rest, without any dose.

use std::array;

use pump_model::{DEFAULT_TOLERANCE, Friction, Leg, ModelError, Pump, RollerCentric, SteadyState};
use serde::Serialize;
use thiserror::Error;

use crate::simulation::EqualTimes;
use crate::simulation::{Integration, Method, Waveform};
use crate::words::{words, words_of_reports};

/// Most samples that a run may have.
pub const MAX_SAMPLES: f64 = 1e9;

/// Which method is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum AskedMethod {
    /// The exact solution where there is one.
    #[default]
    Auto,
    /// The exact solution.
    Exact,
    /// The integrator.
    Rodas5p,
}

words!(AskedMethod { Auto = "auto", Exact = "exact", Rodas5p = "rodas5p" });

/// The model of the rollers that a run computes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ModelName {
    /// Flows at the rollers drive the lines.
    #[default]
    FlowCentric,
    /// Every roller is a valve, every segment between two rollers a chamber (experimental).
    RollerCentric,
}

words_of_reports!(ModelName { FlowCentric = "flow-centric", RollerCentric = "roller-centric" });

/// A method that does not fit what is to be computed.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[non_exhaustive]
pub enum MethodError {
    /// The roller-centric model has no exact solution.
    #[error(
        "the roller-centric model is not linear and has no exact solution; allowed: method auto or rodas5p"
    )]
    ExactRollerCentric,
    /// Friction has no exact solution.
    #[error(
        "the friction of a hose grows with the flow and has no exact solution; allowed: method auto or rodas5p, or a pump \
         file that gives the lines' R, C and L in place of their hoses"
    )]
    ExactFriction,
    /// A tolerance for what has no error.
    #[error(
        "tolerance is {tolerance}, but the exact solution has none; allowed: none, or method \"rodas5p\""
    )]
    ToleranceOfExact {
        /// What was given.
        tolerance: f64,
    },
}

/// The method for a model, the frictions of the hoses that inlet and outlet line are, and what is asked for. Without a
/// `tolerance` the integrator takes [`DEFAULT_TOLERANCE`].
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

/// A run at constant speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Simulation {
    /// Speed, rad/s; not zero; negative in reverse.
    pub speed_rad_s: f64,
    /// How long, s, positive.
    pub duration_s: f64,
    /// Time between samples, s, positive.
    pub dt_s: f64,
    /// How the pressures are computed.
    pub method: Method,
}

impl Simulation {
    /// An exact run.
    pub fn new(speed_rad_s: f64, duration_s: f64, dt_s: f64) -> Self {
        Self { speed_rad_s, duration_s, dt_s, method: Method::Exact }
    }

    /// Refuses what cannot be run.
    pub fn validate(&self) -> Result<(), ModelError> {
        let out = |parameter, value, allowed| Err(ModelError::OutOfRange { parameter, value, allowed });
        if !(1e-6..=1e4).contains(&self.speed_rad_s.abs()) {
            return out("speed in rad/s", self.speed_rad_s, "1e-6 to 1e4 either way");
        }
        if !(self.duration_s > 0.0 && self.duration_s <= 1e7) {
            return out("duration in s", self.duration_s, "more than 0, 1e7 at most");
        }
        if !(self.dt_s > 0.0 && self.dt_s <= self.duration_s) {
            return out("dt in s", self.dt_s, "more than 0, no more than the duration");
        }
        if self.duration_s / self.dt_s > MAX_SAMPLES {
            return out("number of samples", self.duration_s / self.dt_s, "1e9 at most; use a longer dt");
        }
        Ok(())
    }

    /// The periodic steady state that it tends to.
    pub fn steady_state(&self, pump: &Pump) -> Result<SteadyState, ModelError> {
        self.validate()?;
        self.method.steady_state(pump, self.speed_rad_s)
    }

    /// Number of intervals: the samples are at n dt, both ends included where the duration is a multiple of dt.
    pub fn intervals(&self) -> u64 {
        // A duration of 10 s and a dt of 1 ms are 10,000 intervals whatever their quotient rounds to.
        let quotient = self.duration_s / self.dt_s;
        let nearest = quotient.round();
        if (quotient - nearest).abs() <= 1e-9 * nearest { nearest as u64 } else { quotient as u64 }
    }

    /// The samples in order.
    pub fn samples<'a>(
        &self,
        pump: &'a Pump,
    ) -> Result<Waveform<'a, array::IntoIter<Leg, 1>, EqualTimes>, ModelError> {
        self.validate()?;
        let legs = [Leg::constant_speed(0.0, self.speed_rad_s)];
        Waveform::every(pump, legs, self.method, self.dt_s, self.intervals())
    }
}

/// Statistics of the periodic steady state, named as in JSON and Python.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SteadyReport {
    /// Smallest inlet pressure, kPa absolute.
    pub inlet_min_kpa: f64,
    /// Largest.
    pub inlet_max_kpa: f64,
    /// Mean.
    pub inlet_mean_kpa: f64,
    /// Smallest outlet pressure, kPa absolute.
    pub outlet_min_kpa: f64,
    /// Largest.
    pub outlet_max_kpa: f64,
    /// Mean.
    pub outlet_mean_kpa: f64,
    /// Mean flow, mL/s.
    pub mean_flow_ml_s: f64,
    /// (Largest - smallest) / mean of the flow at the outlet rollers.
    pub ripple_peak_to_peak: f64,
    /// Standard deviation / mean of the flow at the outlet rollers.
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
