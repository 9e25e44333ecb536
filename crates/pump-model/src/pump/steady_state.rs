//! The periodic steady state at constant speed, in closed form.

use crate::error::{ModelError, Parameter, refused};
use crate::line::exact_run::ExactRun;
use crate::line::extremes::Extremes;
use crate::line::fine_steps::FineSteps;
use crate::line::line_state::LineState;
use crate::line::oscillator::Oscillator;
use crate::line::periodic_state::{periodic_state, periodic_state_by};
use crate::motion::leg::Leg;
use crate::motion::ripple::Ripple;
use crate::port::Port;
use crate::units::TURN_RAD;

use super::pump::Pump;

/// Largest number of steps over a pitch in search of a steady state's extremes. Each takes about a
/// microsecond.
const MOST_STEPS: f64 = 1e6;

/// Pressures, mean flow and ripple of a pump at constant speed, once start-up is forgotten.
///
/// ```
/// let pump = pump_model::Pump::three_roller();
/// let steady = pump.steady_state(pump_model::units::rad_s(100.0))?;
/// assert!((steady.outlet.max_kpa - 104.5105).abs() < 1e-4);
/// assert!((steady.outlet.min_kpa - 83.5685).abs() < 1e-4);
/// assert!((steady.inlet_mean_kpa - 84.7002).abs() < 1e-4);
/// # Ok::<(), pump_model::ModelError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct SteadyState {
    /// Range of the inlet pressure, kPa absolute.
    pub inlet: Extremes,
    /// Mean inlet pressure, kPa absolute.
    pub inlet_mean_kpa: f64,
    /// Range of the outlet pressure, kPa absolute.
    pub outlet: Extremes,
    /// Mean outlet pressure, kPa absolute.
    pub outlet_mean_kpa: f64,
    /// Mean flow, mL/s.
    pub mean_flow_ml_s: f64,
    /// Ripple of the flow at the outlet rollers.
    pub ripple: Ripple,
}

/// Refuses a speed at which nothing repeats itself: zero, or not finite.
pub(crate) fn moving(speed_rad_s: f64) -> Result<(), ModelError> {
    if speed_rad_s.is_finite() && speed_rad_s != 0.0 {
        Ok(())
    } else {
        Err(refused(Parameter::Speed, speed_rad_s, "a finite speed other than zero"))
    }
}

impl Pump {
    /// Returns the periodic steady state at `speed_rad_s`, which must not be zero; negative in reverse.
    ///
    /// The means follow from L dQ_L/dt = 0 over a period: P = P_res -+ R Q_avg.
    ///
    /// # Errors
    ///
    /// Refuses a speed that is zero or not finite, and a resonance that nothing damps. Also refuses a line
    /// that swings more than a hundred thousand times a pitch, as one without resistance does near
    /// standstill.
    pub fn steady_state(&self, speed_rad_s: f64) -> Result<SteadyState, ModelError> {
        self.steady_states().at(speed_rad_s)
    }

    /// Prepares what the steady states of all speeds share.
    pub fn steady_states(&self) -> SteadyStates<'_> {
        let steps = |port| FineSteps::new(&Oscillator::new(self.line(port), port));
        SteadyStates {
            pump: self,
            inlet: steps(Port::Inlet),
            outlet: steps(Port::Outlet),
            ripple: self.outlet_curve().ripple(),
        }
    }

    /// Returns the state of a port's line at angle 0 that repeats itself every pitch at `speed_rad_s`. The speed
    /// must not be zero.
    ///
    /// # Errors
    ///
    /// Returns [`ModelError::UndampedResonance`] at a resonance that nothing damps.
    pub fn periodic_state(&self, port: Port, speed_rad_s: f64) -> Result<LineState, ModelError> {
        periodic_state(self.line(port), self.curve(port), port, speed_rad_s)
    }

    /// Returns the flow averaged over whole pitches, mL/s: Q_avg = V_rot omega / (2 pi).
    ///
    /// ```
    /// let pump = pump_model::Pump::three_roller();
    /// let flow = pump.average_flow_ml_s(100.0 * core::f64::consts::TAU / 60.0);
    /// assert!((flow - 35.5308).abs() < 1e-4);
    /// ```
    pub fn average_flow_ml_s(&self, speed_rad_s: f64) -> f64 {
        self.revolution_ml() * speed_rad_s / TURN_RAD
    }
}

/// The periodic steady states of a pump, with what they share at all speeds prepared.
///
/// ```
/// let pump = pump_model::Pump::three_roller();
/// let states = pump.steady_states();
/// for speed_rad_s in [1.0, 10.0, -10.0] {
///     assert_eq!(states.at(speed_rad_s)?, pump.steady_state(speed_rad_s)?);
/// }
/// # Ok::<(), pump_model::ModelError>(())
/// ```
#[derive(Debug, Clone)]
pub struct SteadyStates<'a> {
    pump: &'a Pump,
    inlet: FineSteps,
    outlet: FineSteps,
    ripple: Ripple,
}

impl SteadyStates<'_> {
    /// Returns the periodic steady state at `speed_rad_s`, as [`Pump::steady_state`] does.
    ///
    /// # Errors
    ///
    /// As [`Pump::steady_state`].
    pub fn at(&self, speed_rad_s: f64) -> Result<SteadyState, ModelError> {
        moving(speed_rad_s)?;
        let flow = self.pump.average_flow_ml_s(speed_rad_s);
        let (inlet, outlet) = (self.pump.inlet(), self.pump.outlet());
        Ok(SteadyState {
            inlet: self.extremes(Port::Inlet, &self.inlet, speed_rad_s)?,
            inlet_mean_kpa: inlet.reservoir_kpa - inlet.resistance_kpa_s_ml * flow,
            outlet: self.extremes(Port::Outlet, &self.outlet, speed_rad_s)?,
            outlet_mean_kpa: outlet.reservoir_kpa + outlet.resistance_kpa_s_ml * flow,
            mean_flow_ml_s: flow,
            ripple: self.ripple,
        })
    }

    fn extremes(&self, port: Port, steps: &FineSteps, speed_rad_s: f64) -> Result<Extremes, ModelError> {
        let (line, curve) = (self.pump.line(port), self.pump.curve(port));
        let period_s = self.pump.pitch_rad() / speed_rad_s.abs();
        let most = Oscillator::new(line, port).most_fine_steps(curve.pieces().len() as f64, period_s);
        if most > MOST_STEPS {
            return Err(ModelError::RingsTooLong { port, speed_rad_s, steps: most, allowed: MOST_STEPS });
        }
        let state = periodic_state_by(steps, line, curve, port, speed_rad_s)?;
        let motion = [Leg::constant_speed(0.0, speed_rad_s)];
        Ok(ExactRun::on(line, curve, port, motion, state).extremes_by(&mut steps.clone(), period_s))
    }
}
