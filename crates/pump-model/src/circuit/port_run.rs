//! Integration of one port over a motion: steps, states at given times, extremes.

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

/// Tolerance of a step, relative to 1 kPa plus |P - P_res|.
///
/// It keeps the pressures of the published pumps within 1e-4 kPa of the exact ones. Between the long steps of
/// motion slower than 1 r/min it keeps them within 5e-4 kPa.
pub const DEFAULT_TOLERANCE: f64 = 1e-5;

/// Range of tolerances that double precision can meet.
pub(crate) const TOLERANCES: core::ops::RangeInclusive<f64> = 1e-13..=0.1;

/// The integration of one port over a motion, pulled forward by its user.
///
/// With `N = 2` the state is P - P_res in kPa and the line's flow in mL/s. With `N = 3` it also has the
/// volume through the line in mL.
///
/// The type `R` is the resistance of the line. It is R of the pump's line or a hose's friction
/// ([`PortRun::with_friction`]). The exact solution ([`crate::ExactRun`]) takes only R of the line.
///
/// ```
/// use pump_model::{DEFAULT_TOLERANCE, Leg, Port, PortRun, Pump, math};
/// let pump = Pump::three_roller();
/// let motion = [Leg::constant_speed(0.0, math::rad_s(100.0))];
/// let mut run = PortRun::<_, 2>::from_rest(&pump, Port::Outlet, motion, DEFAULT_TOLERANCE)?;
/// // Start-up is forgotten after 3 s; a revolution takes 0.6 s.
/// run.run_to(3.0)?;
/// let extremes = run.extremes(3.6)?;
/// assert!((extremes.max_kpa - 104.5105).abs() < 1e-3 && (extremes.min_kpa - 83.5685).abs() < 1e-3);
/// # Ok::<(), pump_model::IntegrationError>(())
/// ```
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
    /// Starts in `state` when the first of the `legs` starts. `tolerance` is that of a step, as in
    /// [`DEFAULT_TOLERANCE`], 1e-13 to 0.1.
    ///
    /// # Errors
    ///
    /// Returns [`IntegrationError::Tolerance`] if the tolerance lies outside its range.
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
    ///
    /// # Errors
    ///
    /// Returns [`IntegrationError::Tolerance`] if the tolerance lies outside 1e-13 to 0.1.
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
    /// Starts as [`PortRun::new`] does, with a hose's friction in place of R of the port's line. C and L stay
    /// those of the line.
    ///
    /// # Errors
    ///
    /// Returns [`IntegrationError::Tolerance`] if the tolerance lies outside 1e-13 to 0.1.
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
    /// Starts as [`PortRun::new`] does, with `resistance` in place of R of the port's line. C and L stay
    /// those of the line.
    ///
    /// # Errors
    ///
    /// Returns [`IntegrationError::Tolerance`] if the tolerance lies outside 1e-13 to 0.1.
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

    /// Makes one step that ends at `stop_s` at the latest. Returns none once that time is reached.
    ///
    /// # Errors
    ///
    /// Fails if the state is not finite or no step meets the tolerance.
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

    /// Returns the state at `t_s`. `t_s` must not lie before the last step taken, and the times of later
    /// calls must not fall.
    ///
    /// # Errors
    ///
    /// Fails if the state is not finite or no step meets the tolerance.
    pub fn at(&mut self, t_s: f64) -> Result<SVector<f64, N>, IntegrationError> {
        // A step may pass `t_s`: dense output serves the samples inside it.
        while self.solver.time_s() < t_s && self.step(f64::INFINITY)?.is_some() {}
        Ok(match &self.last {
            Some(step) if t_s < step.end_s() => step.at(t_s),
            _ => self.solver.state(),
        })
    }

    /// Returns the state at `end_s`, with a step that ends there. Later calls start from it.
    ///
    /// # Errors
    ///
    /// Fails if the state is not finite or no step meets the tolerance.
    pub fn run_to(&mut self, end_s: f64) -> Result<SVector<f64, N>, IntegrationError> {
        while self.step(end_s)?.is_some() {}
        Ok(self.solver.state())
    }

    /// Returns the smallest and largest pressure from now until `end_s`, kPa absolute.
    ///
    /// # Errors
    ///
    /// Fails if the state is not finite or no step meets the tolerance.
    pub fn extremes(&mut self, end_s: f64) -> Result<Extremes, IntegrationError> {
        let mut extremes = Extremes::at(self.solver.state()[0]);
        while let Some(step) = self.step(end_s)? {
            let ((_, low), (_, high)) = step.polynomial(0).range_in(0.0, 1.0);
            extremes.cover(low);
            extremes.cover(high);
        }
        Ok(extremes.above(self.line.reservoir_kpa))
    }

    /// Returns the state reached.
    pub fn state(&self) -> SVector<f64, N> {
        self.solver.state()
    }

    /// Returns the cost of the integration so far.
    pub fn statistics(&self) -> Statistics {
        self.solver.statistics()
    }
}
