//! The periodic steady state at constant speed, in closed form.

use crate::error::ModelError;
use crate::exact::ExactRun;
use crate::extremes::Extremes;
use crate::flow_curve::{FlowCurve, Port};
use crate::line::Line;
use crate::math::TURN_RAD;
use crate::motion::Leg;
use crate::propagator::{Oscillator, Propagator};
use crate::pump::Pump;
use crate::ripple::Ripple;

/// Steps over a pitch in search of a steady state's extremes, of which each takes about a microsecond.
const MOST_STEPS: f64 = 1e6;

/// What a pump does at constant speed once start-up is forgotten.
#[derive(Debug, Clone, Copy, PartialEq)]
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

impl Pump {
    /// Periodic steady state at `speed_rad_s`, which must not be zero; negative in reverse. Refused are a resonance that nothing
    /// damps and a line that swings more than a hundred thousand times a pitch, as one without resistance near standstill.
    ///
    /// The means follow from L dQ_L/dt = 0 over a period: P = P_res -+ R Q_avg.
    pub fn steady_state(&self, speed_rad_s: f64) -> Result<SteadyState, ModelError> {
        if !(speed_rad_s.is_finite() && speed_rad_s != 0.0) {
            return Err(ModelError::OutOfRange {
                parameter: "speed in rad/s",
                value: speed_rad_s,
                allowed: "a finite speed other than zero",
            });
        }
        let flow = self.average_flow_ml_s(speed_rad_s);
        let inlet = self.inlet();
        let outlet = self.outlet();
        Ok(SteadyState {
            inlet: self.periodic_extremes(Port::Inlet, speed_rad_s)?,
            inlet_mean_kpa: inlet.reservoir_kpa - inlet.resistance_kpa_s_ml * flow,
            outlet: self.periodic_extremes(Port::Outlet, speed_rad_s)?,
            outlet_mean_kpa: outlet.reservoir_kpa + outlet.resistance_kpa_s_ml * flow,
            mean_flow_ml_s: flow,
            ripple: self.outlet_curve().ripple(),
        })
    }

    /// State (P - P_res in kPa, the line's flow in mL/s) of a port at angle 0 that repeats itself every pitch at
    /// `speed_rad_s`.
    pub fn periodic_state(&self, port: Port, speed_rad_s: f64) -> Result<[f64; 2], ModelError> {
        periodic_state(self.line(port), self.curve(port), port, speed_rad_s)
    }

    fn periodic_extremes(&self, port: Port, speed_rad_s: f64) -> Result<Extremes, ModelError> {
        let period_s = self.pitch_rad() / speed_rad_s.abs();
        let edges = self.curve(port).precomputed_pieces().count() as f64;
        let steps = Oscillator::new(self.line(port), port).most_fine_steps(edges, period_s);
        if steps > MOST_STEPS {
            let port = port.name();
            return Err(ModelError::RingsTooLong { port, speed_rad_s, steps, allowed: MOST_STEPS });
        }
        let state = self.periodic_state(port, speed_rad_s)?;
        let motion = [Leg::constant_speed(0.0, speed_rad_s)];
        Ok(ExactRun::new(self, port, motion, state).extremes(period_s))
    }

    /// Flow averaged over whole pitches, Q_avg = V_rot omega / (2 pi), mL/s.
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

/// State of `line` at angle 0 that repeats itself every pitch of `curve`, the flow curve of `port`.
///
/// The state after a period T is e^(A T) z + b, so that z = -(e^(A T) - I)^-1 b. Undamped resonance has none; of a period long
/// against the decay e^(A T) is 0 and z is b.
pub(crate) fn periodic_state(
    line: &Line,
    curve: &FlowCurve,
    port: Port,
    speed_rad_s: f64,
) -> Result<[f64; 2], ModelError> {
    let oscillator = Oscillator::new(line, port);
    let period_s = curve.pitch_rad() / speed_rad_s.abs();
    let motion = [Leg::constant_speed(0.0, speed_rad_s)];
    let [bx, by] = oscillator.balanced(ExactRun::on(line, curve, port, motion, [0.0; 2]).at(period_s));
    let [[a, c], [b, d]] = Propagator::new(&oscillator, period_s, 0).change();
    let determinant = a * d - b * c;
    // An eigenvalue of e^(A T) is known to rounding times the phase turned, as far as it has not died out. A line that does
    // not swing has no resonance.
    let rounding = oscillator.swing_left(period_s) * 1e-12 * (1.0 + oscillator.norm() * period_s);
    if determinant == 0.0 || determinant.abs() < rounding * rounding {
        return Err(ModelError::UndampedResonance { port: port.name(), speed_rad_s });
    }
    Ok(oscillator.physical([(b * by - d * bx) / determinant, (c * bx - a * by) / determinant]))
}
