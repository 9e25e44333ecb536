//! A line as an oscillator: states in coordinates that carry energy alike, and their rates of change.

use libm::sqrt;

use crate::math::hermite::{self, End};
use crate::math::polynomial::Polynomial;
use crate::motion::flow::Flow;
use crate::port::Port;

use super::line::Line;

/// Largest |A| h of steps that are summed by their Taylor series.
pub(crate) const SHORT: f64 = 0.5;

/// A line in coordinates in which both states carry energy alike: x = p, y = Q_L z with z = sqrt(L/C).
///
/// With s = 1 at the outlet and -1 at the inlet and w = 1/sqrt(L C), the circuit of `circuit/ode.rs` reads
/// dx/dt = s w (z f - y), dy/dt = s w x - (R/L) y.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Oscillator {
    /// Signed natural frequency s w, rad/s.
    pub(crate) rate: f64,
    /// Decay rate R/L, 1/s.
    pub(crate) decay: f64,
    /// Impedance z, kPa s/mL.
    pub(crate) impedance: f64,
    /// Admittance 1/z, mL/(s kPa).
    admittance: f64,
}

/// State (x, y) of an [`Oscillator`], kPa.
pub(crate) type Balanced = [f64; 2];

impl Oscillator {
    pub(crate) fn new(line: &Line, port: Port) -> Self {
        let sign = match port {
            Port::Inlet => -1.0,
            Port::Outlet => 1.0,
        };
        Self {
            rate: sign * line.natural_rad_s(),
            decay: line.resistance_kpa_s_ml / line.inertance_kpa_s2_ml,
            impedance: sqrt(line.inertance_kpa_s2_ml / line.compliance_ml_kpa),
            admittance: sqrt(line.compliance_ml_kpa / line.inertance_kpa_s2_ml),
        }
    }

    /// Converts a state from (pressure above the reservoir in kPa, flow in mL/s).
    pub(crate) fn balanced(&self, state: [f64; 2]) -> Balanced {
        [state[0], state[1] * self.impedance]
    }

    /// Converts a state to (pressure above the reservoir in kPa, flow in mL/s).
    #[inline]
    pub(crate) fn physical(&self, state: Balanced) -> [f64; 2] {
        [state[0], state[1] * self.admittance]
    }

    /// Returns a bound of |A|, the largest rate of change of the states, 1/s.
    pub(crate) fn norm(&self) -> f64 {
        self.rate.abs() + self.decay
    }

    /// Returns A z for a state z.
    pub(crate) fn times(&self, state: Balanced) -> Balanced {
        [-self.rate * state[1], self.rate * state[0] - self.decay * state[1]]
    }

    /// Returns dz/dt where the flow at the rollers is `flow`.
    pub(crate) fn derivative(&self, state: Balanced, flow: f64) -> Balanced {
        let [x, y] = self.times(state);
        [x + self.rate * self.impedance * flow, y]
    }

    /// Returns the pressure between two states over the fraction of the time passed, 0 to 1. `flow` counts
    /// time from `before`.
    pub(crate) fn pressure(
        &self,
        length_s: f64,
        before: Balanced,
        after: Balanced,
        flow: &Flow,
    ) -> Polynomial {
        let end = |state: Balanced, t| {
            let slope = self.derivative(state, flow.at(t));
            let curvature = self.derivative(slope, flow.rate_at(t));
            End { value: state[0], slope: slope[0], curvature: curvature[0] }
        };
        Polynomial { c: hermite::quintic(length_s, &end(before, 0.0), &end(after, length_s)) }
    }
}
