//! The flow-centric model of one port as a differential equation (McIntyre et al.).

use nalgebra::{SMatrix, SVector};

use crate::head::port::Port;
use crate::integrator::{Ode, Options};
use crate::line::line::Line;
use crate::math::sqrt;
use crate::motion::stretches::Stretch;

use super::resistance::{Linear, Resistance};

/// Flow at the rollers into or out of a line.
pub trait Forcing {
    /// Flow at the rollers at time `t_s`, mL/s, positive from inlet to outlet.
    fn flow_ml_s(&self, t_s: f64) -> f64;
    /// Time derivative of the flow at the rollers, mL/s².
    fn flow_rate_ml_s2(&self, t_s: f64) -> f64;
}

impl Forcing for Stretch {
    fn flow_ml_s(&self, t_s: f64) -> f64 {
        Self::flow_ml_s(self, t_s)
    }
    fn flow_rate_ml_s2(&self, t_s: f64) -> f64 {
        Self::flow_rate_ml_s2(self, t_s)
    }
}

/// Rollers at rest: there is no flow at the rollers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NoFlow;

impl Forcing for NoFlow {
    fn flow_ml_s(&self, _t_s: f64) -> f64 {
        0.0
    }
    fn flow_rate_ml_s2(&self, _t_s: f64) -> f64 {
        0.0
    }
}

/// One port of the pump between the rollers and the reservoir.
///
/// The state is p = P - P_res, kPa, and the line's flow Q_L, mL/s, positive from inlet to outlet. With
/// `N = 3` the state also has the volume that has passed the line, mL. With s = 1 at the outlet and -1 at the
/// inlet:
///
/// C dp/dt = s (Q - Q_L), L dQ_L/dt = s p - dP(Q_L), dV/dt = Q_L
///
/// dP(Q_L) is R Q_L for a [`Linear`] resistance.
#[derive(Debug, Clone, Copy)]
pub struct Circuit<F, R = Linear> {
    /// s/C, kPa/mL.
    pressure_per_volume: f64,
    /// s/L, mL/(s² kPa).
    flow_rate_per_pressure: f64,
    resistance: R,
    /// Q, the flow at the rollers.
    forcing: F,
}

impl<F: Forcing, R: Resistance> Circuit<F, R> {
    /// Builds the circuit of a valid line at a port. It takes C and L from the line; `resistance` replaces
    /// the line's R.
    pub fn new(line: &Line, resistance: R, port: Port, forcing: F) -> Self {
        let sign = match port {
            Port::Inlet => -1.0,
            Port::Outlet => 1.0,
        };
        Self {
            pressure_per_volume: sign / line.compliance_ml_kpa,
            flow_rate_per_pressure: sign / line.inertance_kpa_s2_ml,
            resistance,
            forcing,
        }
    }
}

impl<F: Forcing, R: Resistance, const N: usize> Ode<N> for Circuit<F, R> {
    fn derivative(&self, t: f64, y: &SVector<f64, N>) -> SVector<f64, N> {
        const { assert!(N == 2 || N == 3, "pressure and flow, or these and the volume") };
        let (pressure, flow) = (y[0], y[1]);
        let mut dy = SVector::zeros();
        dy[0] = self.pressure_per_volume * (self.forcing.flow_ml_s(t) - flow);
        dy[1] = self.flow_rate_per_pressure * pressure - self.resistance.deceleration_ml_s2(flow);
        if N == 3 {
            dy[2] = flow;
        }
        dy
    }

    fn jacobian(&self, _t: f64, y: &SVector<f64, N>) -> SMatrix<f64, N, N> {
        let mut j = SMatrix::zeros();
        j[(0, 1)] = -self.pressure_per_volume;
        j[(1, 0)] = self.flow_rate_per_pressure;
        j[(1, 1)] = -self.resistance.damping_per_s(y[1]);
        if N == 3 {
            j[(2, 1)] = 1.0;
        }
        j
    }

    fn time_derivative(&self, t: f64, _y: &SVector<f64, N>) -> SVector<f64, N> {
        let mut ft = SVector::zeros();
        ft[0] = self.pressure_per_volume * self.forcing.flow_rate_ml_s2(t);
        ft
    }
}

/// Returns the errors allowed in a step of a [`Circuit`].
///
/// The pressure may err by `tolerance` times `scale_kpa` + |P - P_res|. Flow and volume may err by the
/// amounts that carry the same energy. The volume's error is that of the flow it integrates, so it has no
/// part relative to the volume itself.
pub fn options<const N: usize>(line: &Line, tolerance: f64, scale_kpa: f64) -> Options<N> {
    let mut options = Options::uniform(tolerance);
    options.absolute[0] = tolerance * scale_kpa;
    options.absolute[1] = tolerance * scale_kpa * flow_scale_ml_s(line);
    if N == 3 {
        options.absolute[2] = tolerance * scale_kpa * line.compliance_ml_kpa;
        options.relative[2] = 0.0;
    }
    options
}

/// Flow that carries as much energy as 1 kPa of pressure: sqrt(C/L), mL/s.
pub(crate) fn flow_scale_ml_s(line: &Line) -> f64 {
    sqrt(line.compliance_ml_kpa / line.inertance_kpa_s2_ml)
}
