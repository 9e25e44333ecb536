//! The periodic steady state at constant speed, by the integrator.

use nalgebra::{SMatrix, SVector};

use crate::error::ModelError;
use crate::flow_curve::{Port, Ripple};
use crate::integrator::Lu;
use crate::math::TURN_RAD;
use crate::motion::Leg;
use crate::port_run::{Extremes, PortRun};
use crate::pump::Pump;

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
    /// Periodic steady state at `speed_rad_s`, which must not be zero.
    ///
    /// The model is linear, so the state at the end of a pitch is Phi y + b; three integrations over a pitch give Phi
    /// and b, and y = (I - Phi)^-1 b repeats itself. The means follow from L dQ_L/dt = 0 over a period:
    /// P = P_res -+ R Q_avg.
    pub fn steady_state(&self, speed_rad_s: f64, tolerance: f64) -> Result<SteadyState, ModelError> {
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
            inlet: periodic_extremes(self, Port::Inlet, speed_rad_s, tolerance)?,
            inlet_mean_kpa: inlet.reservoir_kpa - inlet.resistance_kpa_s_ml * flow,
            outlet: periodic_extremes(self, Port::Outlet, speed_rad_s, tolerance)?,
            outlet_mean_kpa: outlet.reservoir_kpa + outlet.resistance_kpa_s_ml * flow,
            mean_flow_ml_s: flow,
            ripple: self.outlet_curve().ripple(),
        })
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

fn periodic_extremes(
    pump: &Pump,
    port: Port,
    speed_rad_s: f64,
    tolerance: f64,
) -> Result<Extremes, ModelError> {
    let period_s = pump.pitch_rad() / speed_rad_s.abs();
    let motion = [Leg::constant_speed(0.0, speed_rad_s)];
    let run = |state| PortRun::<_, 2>::new(pump, port, motion, state, tolerance);
    let after = |state| run(state).and_then(|mut run| run.run_to(period_s));

    // Unit states of one energy, so that a stiff line does not spoil the matrix.
    let scale = pump.line(port).flow_scale_ml_s();
    let offset: SVector<f64, 2> = after(SVector::zeros())?;
    let pressure = after(SVector::<f64, 2>::new(1.0, 0.0))? - offset;
    let flow = (after(SVector::<f64, 2>::new(0.0, scale))? - offset) / scale;
    let map = SMatrix::<f64, 2, 2>::from_columns(&[pressure, flow]);
    let singular = || ModelError::UndampedResonance { port: port.name(), speed_rad_s };
    let difference = SMatrix::<f64, 2, 2>::identity() - map;
    // |det(I - Phi)| is the product of both modes' distances from repeating undamped.
    let [m00, m10, m01, m11] = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|place| difference[place]);
    if (m00 * m11 - m01 * m10).abs() < 1e-9 {
        return Err(singular());
    }
    let start = Lu::new(difference).ok_or_else(singular)?.solve(offset);
    Ok(run(start)?.extremes(period_s)?)
}
