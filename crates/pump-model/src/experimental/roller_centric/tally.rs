//! Sums and extremes of one port's pressures and flows over a pitch.

use libm::sqrt;

use crate::circuit::lumped::outward;
use crate::circuit::tally::PressureTally;
use crate::integrator::COEFFICIENTS;
use crate::line::line::Line;
use crate::math::polynomial::Polynomial;
use crate::motion::ripple::{Ripple, square_integral};
use crate::port::Port;

/// Sums and extremes of one port's pressures and flows over a pitch, gathered step by step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tally {
    /// Signed compliance s C, mL/kPa, with s = 1 at the outlet and -1 at the inlet.
    compliance_ml_kpa: f64,
    pub(super) pressure: PressureTally,
    /// Smallest flow at the rollers, mL/s.
    least_ml_s: f64,
    /// Largest flow at the rollers, mL/s.
    most_ml_s: f64,
    /// Integral of the square of the flow at the rollers, mL²/s.
    square_ml2_s: f64,
}

impl Tally {
    pub(super) fn new(line: &Line, port: Port) -> Self {
        Self {
            compliance_ml_kpa: outward(port) * line.compliance_ml_kpa,
            pressure: PressureTally::EMPTY,
            least_ml_s: f64::INFINITY,
            most_ml_s: f64::NEG_INFINITY,
            square_ml2_s: 0.0,
        }
    }

    /// Adds a step of `length_s`. `pressure` is in kPa and `flow`, that of the line, in mL/s, both over the
    /// fraction of the step from 0 to 1.
    pub(super) fn add(
        &mut self,
        length_s: f64,
        pressure: &Polynomial<COEFFICIENTS>,
        flow: &Polynomial<COEFFICIENTS>,
    ) {
        self.pressure.add(length_s, pressure);
        // s C dP/dt = Q - Q_L, so the flow at the rollers is a polynomial too.
        let at_rollers = flow.plus(&pressure.derivative().scaled(self.compliance_ml_kpa / length_s));
        let ((_, low), (_, high)) = at_rollers.range_in(0.0, 1.0);
        self.least_ml_s = self.least_ml_s.min(low);
        self.most_ml_s = self.most_ml_s.max(high);
        self.square_ml2_s += length_s * square_integral(|x| at_rollers.at(x), 1.0);
    }

    /// Returns the ripple of the flow at the rollers, whose mean is that of the line, mL/s.
    pub(super) fn ripple(&self, mean_ml_s: f64) -> Ripple {
        let mean = mean_ml_s.abs();
        Ripple {
            peak_to_peak: (self.most_ml_s - self.least_ml_s) / mean,
            rms: sqrt((self.square_ml2_s / self.pressure.time_s - mean * mean).max(0.0)) / mean,
        }
    }
}
