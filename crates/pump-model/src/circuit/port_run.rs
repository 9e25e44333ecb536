//! One port followed over a motion: steps, states at given times, extremes.

use nalgebra::SVector;

use crate::error::IntegrationError;
use crate::head::port::Port;
use crate::integrator::{DenseStep, Rodas5p, Statistics};
use crate::line::extremes::Extremes;
use crate::line::friction::Friction;
use crate::line::line::Line;
use crate::motion::leg::Leg;
use crate::motion::stretches::{Stretch, Stretches};
use crate::pump::pump::Pump;

use super::ode::{Circuit, options};
use super::resistance::{Linear, Resistance, Rough};

/// Error allowed in a step, relative to 1 kPa plus |P - P_res|. It keeps the pressures of the published pumps within
/// 1e-4 kPa of the exact ones, and within 5e-4 kPa between the long steps of motion slower than 1 r/min.
pub const DEFAULT_TOLERANCE: f64 = 1e-5;

/// Tolerances that double precision can meet.
pub(crate) const TOLERANCES: core::ops::RangeInclusive<f64> = 1e-13..=0.1;

/// The integration of one port over a motion, pulled forward by its user.
///
/// `N = 2`: P - P_res in kPa and the line's flow in mL/s; `N = 3`: the volume through the line in mL too. Its type says
/// what the line resists: R of the pump's line, or a hose's friction ([`PortRun::with_friction`]), which the exact
/// solution ([`crate::ExactRun`]) cannot be given.
#[derive(Debug, Clone)]
pub struct PortRun<'a, M, const N: usize, R = Linear> {
    line: &'a Line,
    resistance: R,
    port: Port,
    stretches: Stretches<'a, M>,
    stretch: Option<Stretch>,
    solver: Rodas5p<N>,
    last: Option<DenseStep<N>>,
}

impl<'a, M: Iterator<Item = Leg>, const N: usize> PortRun<'a, M, N> {
    /// Starts in `state` when the first of the `legs` starts. `tolerance` as in [`DEFAULT_TOLERANCE`], 1e-13 to 0.1.
    pub fn new(
        pump: &'a Pump,
        port: Port,
        legs: impl IntoIterator<IntoIter = M>,
        state: SVector<f64, N>,
        tolerance: f64,
    ) -> Result<Self, IntegrationError> {
        Self::resisted(pump, Linear::of(pump.line(port)), port, legs, state, tolerance)
    }

    /// Starts with the line at rest: P = P_res, no flow.
    pub fn from_rest(
        pump: &'a Pump,
        port: Port,
        legs: impl IntoIterator<IntoIter = M>,
        tolerance: f64,
    ) -> Result<Self, IntegrationError> {
        Self::new(pump, port, legs, SVector::zeros(), tolerance)
    }
}

impl<'a, M: Iterator<Item = Leg>, const N: usize> PortRun<'a, M, N, Rough> {
    /// As [`PortRun::new`], with a hose's friction in place of R of the port's line; C and L are the line's.
    pub fn with_friction(
        pump: &'a Pump,
        friction: Friction,
        port: Port,
        legs: impl IntoIterator<IntoIter = M>,
        state: SVector<f64, N>,
        tolerance: f64,
    ) -> Result<Self, IntegrationError> {
        Self::resisted(pump, Rough::new(friction, pump.line(port)), port, legs, state, tolerance)
    }
}

impl<'a, M: Iterator<Item = Leg>, const N: usize, R: Resistance + Copy> PortRun<'a, M, N, R> {
    /// As [`PortRun::new`], with what the line resists in place of its R; C and L are the line's.
    pub fn resisted(
        pump: &'a Pump,
        resistance: R,
        port: Port,
        legs: impl IntoIterator<IntoIter = M>,
        state: SVector<f64, N>,
        tolerance: f64,
    ) -> Result<Self, IntegrationError> {
        if !TOLERANCES.contains(&tolerance) {
            return Err(IntegrationError::Tolerance { tolerance });
        }
        let line = pump.line(port);
        let mut stretches = Stretches::new(pump.curve(port), legs);
        let solver = Rodas5p::new(stretches.time_s(), state, options(line, tolerance, 1.0));
        let stretch = stretches.next();
        Ok(Self { line, resistance, port, stretches, stretch, solver, last: None })
    }

    /// Makes one step that ends at `stop_s` at the latest. None once that time is reached.
    pub fn step(&mut self, stop_s: f64) -> Result<Option<DenseStep<N>>, IntegrationError> {
        if self.solver.time_s() >= stop_s {
            return Ok(None);
        }
        while self.stretch.is_some_and(|stretch| self.solver.time_s() >= stretch.end_s) {
            self.stretch = self.stretches.next();
            self.solver.restart();
        }
        let Some(stretch) = self.stretch else {
            return Ok(None);
        };
        let circuit = Circuit::new(self.line, self.resistance, self.port, stretch);
        let step = self.solver.step(&circuit, stretch.end_s.min(stop_s))?;
        self.last = Some(step);
        Ok(Some(step))
    }

    /// State at `t_s`, which must not lie before the last step taken; times asked for must not fall.
    pub fn at(&mut self, t_s: f64) -> Result<SVector<f64, N>, IntegrationError> {
        // A step may pass `t_s`: dense output serves the samples inside it.
        while self.solver.time_s() < t_s && self.step(f64::INFINITY)?.is_some() {}
        Ok(match &self.last {
            Some(step) if t_s < step.end_s() => step.at(t_s),
            _ => self.solver.state(),
        })
    }

    /// State at `end_s`, with a step that ends there; later calls start from it.
    pub fn run_to(&mut self, end_s: f64) -> Result<SVector<f64, N>, IntegrationError> {
        while self.step(end_s)?.is_some() {}
        Ok(self.solver.state())
    }

    /// Smallest and largest pressure, kPa absolute, from now until `end_s`.
    pub fn extremes(&mut self, end_s: f64) -> Result<Extremes, IntegrationError> {
        let mut extremes = Extremes::at(self.solver.state()[0]);
        while let Some(step) = self.step(end_s)? {
            let ((_, low), (_, high)) = step.polynomial(0).range_in(0.0, 1.0);
            extremes.cover(low);
            extremes.cover(high);
        }
        Ok(extremes.above(self.line.reservoir_kpa))
    }

    /// State reached.
    pub fn state(&self) -> SVector<f64, N> {
        self.solver.state()
    }

    /// Cost of the integration so far.
    pub fn statistics(&self) -> Statistics {
        self.solver.statistics()
    }
}
