//! Integration of any model of a line over a motion: steps, states at given times, extremes.

use crate::error::IntegrationError;
use crate::integrator::{DenseStep, Options, Radau, Rodas5p, Statistics};
use crate::line::extremes::Extremes;
use crate::motion::leg::Leg;
use crate::motion::stretches::{Stretch, Stretches};
use crate::port::Port;
use crate::pump::pump::Pump;

use super::line_model::LineModel;
use super::ode::{Circuit, options};
use super::solver::Solver;

/// Tolerance of a step, relative to 1 kPa plus |P - P_res|.
///
/// It keeps the pressures of the published pumps within 1e-4 kPa of the exact ones. Between the long steps of
/// motion slower than 1 r/min it keeps them within 5e-4 kPa.
pub const DEFAULT_TOLERANCE: f64 = 1e-5;

/// Range of tolerances that double precision can meet.
pub(crate) const TOLERANCES: core::ops::RangeInclusive<f64> = 1e-13..=0.1;

/// The integration of a [`LineModel`] at one port over a motion, pulled forward by its user.
///
/// The model stands in place of the pump's line at that port. Only the reservoir's pressure stays that of the
/// pump's line. [`crate::PortRun`] integrates the pump's own line.
#[derive(Debug, Clone)]
pub struct LineRun<'a, M, L, const N: usize> {
    model: L,
    port: Port,
    reservoir_kpa: f64,
    stretches: Stretches<'a, M>,
    stretch: Option<Stretch>,
    solver: Solver<N>,
    options: Options<N>,
    last: Option<DenseStep<N>>,
}

impl<'a, M: Iterator<Item = Leg>, L: LineModel<N>, const N: usize> LineRun<'a, M, L, N> {
    /// Starts in `state` when the first of the `legs` starts. `tolerance` is that of a step, as in
    /// [`DEFAULT_TOLERANCE`], 1e-13 to 0.1.
    ///
    /// # Errors
    ///
    /// Returns [`IntegrationError::Tolerance`] if the tolerance lies outside its range, and
    /// [`IntegrationError::OutOfRange`] if the model's scale is not positive.
    pub fn new(
        pump: &'a Pump,
        port: Port,
        model: L,
        legs: impl IntoIterator<IntoIter = M>,
        state: [f64; N],
        tolerance: f64,
    ) -> Result<Self, IntegrationError> {
        const { assert!(N > 0, "the pressure at the rollers comes first") };
        if !TOLERANCES.contains(&tolerance) {
            return Err(IntegrationError::Tolerance { tolerance });
        }
        let mut stretches = Stretches::new(pump.curve(port), legs);
        let options = options(&model, tolerance, 1.0);
        let solver = Solver::Rodas5p(Rodas5p::new(stretches.time_s(), state, options)?);
        let stretch = stretches.next();
        let reservoir_kpa = pump.line(port).reservoir_kpa;
        Ok(Self { model, port, reservoir_kpa, stretches, stretch, solver, options, last: None })
    }

    /// Goes on by [`Radau`]'s method, which makes fewer and longer steps. Only a [linear](LineModel::is_linear) model
    /// has it.
    ///
    /// # Errors
    ///
    /// Returns [`IntegrationError::NotLinear`] if the model is not linear.
    pub fn with_radau(self) -> Result<Self, IntegrationError> {
        if !self.model.is_linear() {
            return Err(IntegrationError::NotLinear);
        }
        let solver = Radau::new(self.solver.time_s(), self.solver.state(), self.options)?;
        Ok(Self { solver: Solver::Radau(solver), ..self })
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
        let circuit = Circuit::new(&self.model, self.port, stretch);
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
    pub fn at(&mut self, t_s: f64) -> Result<[f64; N], IntegrationError> {
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
    pub fn run_to(&mut self, end_s: f64) -> Result<[f64; N], IntegrationError> {
        while self.step(end_s)?.is_some() {}
        Ok(self.state())
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
        Ok(extremes.above(self.reservoir_kpa))
    }

    /// Returns the state reached.
    pub fn state(&self) -> [f64; N] {
        self.solver.state()
    }

    /// Returns the cost of the integration so far.
    pub fn statistics(&self) -> Statistics {
        self.solver.statistics()
    }
}
