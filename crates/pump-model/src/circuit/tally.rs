//! Sums and extremes of one port's pressures and flows over a pitch.

use crate::head::port::Port;
use crate::line::extremes::Extremes;
use crate::line::line::Line;
use crate::math::polynomial::Polynomial;
use crate::motion::ripple::square_integral;

/// Sums and extremes of one port's pressures and flows over a pitch, gathered step by step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tally {
    /// Signed compliance s C, mL/kPa, with s = 1 at the outlet and -1 at the inlet.
    compliance_ml_kpa: f64,
    pub(crate) time_s: f64,
    pressure: Extremes,
    pressure_kpa_s: f64,
    /// Smallest flow at the rollers, mL/s.
    pub(crate) least_ml_s: f64,
    /// Largest flow at the rollers, mL/s.
    pub(crate) most_ml_s: f64,
    /// Integral of the square of the flow at the rollers, mL²/s.
    pub(crate) square_ml2_s: f64,
}

impl Tally {
    pub(crate) fn new(line: &Line, port: Port) -> Self {
        let sign = match port {
            Port::Inlet => -1.0,
            Port::Outlet => 1.0,
        };
        Self {
            compliance_ml_kpa: sign * line.compliance_ml_kpa,
            time_s: 0.0,
            pressure: Extremes { min_kpa: f64::INFINITY, max_kpa: f64::NEG_INFINITY },
            pressure_kpa_s: 0.0,
            least_ml_s: f64::INFINITY,
            most_ml_s: f64::NEG_INFINITY,
            square_ml2_s: 0.0,
        }
    }

    /// Adds a step of `length_s`. `pressure` is in kPa and `flow`, that of the line, in mL/s, both over the
    /// fraction of the step from 0 to 1.
    pub(crate) fn add(&mut self, length_s: f64, pressure: &Polynomial, flow: &Polynomial) {
        let ((_, low), (_, high)) = pressure.range_in(0.0, 1.0);
        self.pressure.cover(low);
        self.pressure.cover(high);
        // s C dP/dt = Q - Q_L, so the flow at the rollers is a polynomial too.
        let at_rollers = flow.plus(&pressure.derivative().scaled(self.compliance_ml_kpa / length_s));
        let ((_, low), (_, high)) = at_rollers.range_in(0.0, 1.0);
        self.least_ml_s = self.least_ml_s.min(low);
        self.most_ml_s = self.most_ml_s.max(high);
        self.time_s += length_s;
        self.pressure_kpa_s += length_s * integral(pressure);
        self.square_ml2_s += length_s * square_integral(|x| at_rollers.at(x), 1.0);
    }

    /// Returns the range of the pressure, kPa.
    pub(crate) fn pressure(&self) -> Extremes {
        self.pressure
    }

    /// Returns the mean pressure, kPa.
    pub(crate) fn mean_kpa(&self) -> f64 {
        self.pressure_kpa_s / self.time_s
    }
}

/// Integral of a polynomial over [0, 1].
fn integral(polynomial: &Polynomial) -> f64 {
    polynomial.c.iter().zip(1..).map(|(c, n)| c / f64::from(n)).sum()
}
