//! The line of McIntyre et al. as a model: C at the pump, R and L in series.

use libm::sqrt;

use crate::line::line::Line;
use crate::port::Port;

use super::line_model::LineModel;
use super::resistance::{Deceleration, Linear, Resistance};

/// The built-in model of a line: C at the pump, then a resistance and L in series to the reservoir.
///
/// The states are p = P - P_res, kPa, and the line's flow Q_L, mL/s, positive from inlet to outlet. With
/// `N = 3` the volume that has passed the line is a state too, mL. With s = 1 at the outlet and -1 at the
/// inlet, and s Q as the inflow:
///
/// C dp/dt = s (Q - Q_L), L dQ_L/dt = s p - dP(Q_L), dV/dt = Q_L
///
/// dP(Q_L) is R Q_L for a [`Linear`] resistance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lumped<R = Linear> {
    /// s, 1 at the outlet and -1 at the inlet.
    sign: f64,
    /// s/C, kPa/mL.
    pressure_per_volume: f64,
    /// s/L, mL/(s² kPa).
    flow_rate_per_pressure: f64,
    /// C, mL/kPa.
    compliance_ml_kpa: f64,
    /// Flow that carries as much energy as 1 kPa, mL/s.
    flow_scale_ml_s: f64,
    deceleration: Deceleration<R>,
}

impl<R: Resistance> Lumped<R> {
    /// Builds the model of a valid line at a port. It takes C and L from the line; `resistance` replaces the
    /// line's R.
    pub fn new(line: &Line, resistance: R, port: Port) -> Self {
        let sign = outward(port);
        Self {
            sign,
            pressure_per_volume: sign / line.compliance_ml_kpa,
            flow_rate_per_pressure: sign / line.inertance_kpa_s2_ml,
            compliance_ml_kpa: line.compliance_ml_kpa,
            flow_scale_ml_s: flow_scale_ml_s(line),
            deceleration: Deceleration::new(resistance, line),
        }
    }
}

impl<R: Resistance, const N: usize> LineModel<N> for Lumped<R> {
    #[inline]
    fn derivative(&self, inflow_ml_s: f64, state: &[f64; N]) -> [f64; N] {
        const { assert!(N == 2 || N == 3, "pressure and flow, or these and the volume") };
        let (pressure, flow) = (state[0], state[1]);
        let mut slope = [0.0; N];
        slope[0] = self.pressure_per_volume * (self.sign * inflow_ml_s - flow);
        slope[1] = self.flow_rate_per_pressure * pressure - self.deceleration.at_ml_s2(flow);
        if N == 3 {
            slope[2] = flow;
        }
        slope
    }

    #[inline]
    fn jacobian(&self, _inflow_ml_s: f64, state: &[f64; N]) -> [[f64; N]; N] {
        let mut j = [[0.0; N]; N];
        j[0][1] = -self.pressure_per_volume;
        j[1][0] = self.flow_rate_per_pressure;
        j[1][1] = -self.deceleration.damping_per_s(state[1]);
        if N == 3 {
            j[2][1] = 1.0;
        }
        j
    }

    #[inline]
    fn per_inflow(&self, _inflow_ml_s: f64, _state: &[f64; N]) -> [f64; N] {
        let mut change = [0.0; N];
        change[0] = self.sign * self.pressure_per_volume;
        change
    }

    /// The volume has the scale of the volume that 1 kPa holds in C.
    fn scale(&self) -> [f64; N] {
        let mut scale = [1.0; N];
        scale[1] = self.flow_scale_ml_s;
        if N == 3 {
            scale[2] = self.compliance_ml_kpa;
        }
        scale
    }

    fn totals(&self) -> [bool; N] {
        core::array::from_fn(|state| state == 2)
    }

    fn is_linear(&self) -> bool {
        self.deceleration.is_linear()
    }
}

/// Flow that carries as much energy as 1 kPa of pressure: sqrt(C/L), mL/s.
pub(crate) fn flow_scale_ml_s(line: &Line) -> f64 {
    sqrt(line.compliance_ml_kpa / line.inertance_kpa_s2_ml)
}

/// Returns the sign of a flow from inlet to outlet as an inflow of the port's line: 1 at the outlet, -1 at
/// the inlet.
pub(crate) fn outward(port: Port) -> f64 {
    match port {
        Port::Inlet => -1.0,
        Port::Outlet => 1.0,
    }
}
