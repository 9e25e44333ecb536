//! Integration of the pump's own line at one port over a motion.

use crate::error::IntegrationError;
use crate::integrator::{DenseStep, Statistics};
use crate::line::extremes::Extremes;
use crate::line::friction::Friction;
use crate::line::line_state::LineState;
use crate::motion::leg::Leg;
use crate::port::Port;
use crate::pump::pump::Pump;

use super::line_run::LineRun;
use super::lumped::Lumped;
use super::resistance::{Linear, Resistance};

/// The integration of the pump's own line at one port over a motion, pulled forward by its user.
///
/// A [`LineRun`] integrates other models of a line.
///
/// With `N = 2` pressure and flow of the line are integrated. With `N = 3` the volume through the line is too
/// ([`PortRun::passed_at`]).
///
/// The type `R` is the resistance of the line. It is R of the pump's line or a hose's friction
/// ([`PortRun::with_friction`]). The exact solution ([`crate::ExactRun`]) takes only R of the line.
///
/// ```
/// use pump_model::{DEFAULT_TOLERANCE, Leg, Port, PortRun, Pump, units};
/// let pump = Pump::three_roller();
/// let motion = [Leg::constant_speed(0.0, units::rad_s(100.0))];
/// let mut run = PortRun::<_, 2>::from_rest(&pump, Port::Outlet, motion, DEFAULT_TOLERANCE)?;
/// // Start-up is forgotten after 3 s; a revolution takes 0.6 s.
/// run.run_to(3.0)?;
/// let extremes = run.extremes(3.6)?;
/// assert!((extremes.max_kpa - 104.5105).abs() < 1e-3 && (extremes.min_kpa - 83.5685).abs() < 1e-3);
/// # Ok::<(), pump_model::IntegrationError>(())
/// ```
#[derive(Debug, Clone)]
pub struct PortRun<'a, M, const N: usize, R = Linear> {
    run: LineRun<'a, M, Lumped<R>, N>,
}

impl<'a, M: Iterator<Item = Leg>, const N: usize> PortRun<'a, M, N> {
    /// Starts in `state` when the first of the `legs` starts. `tolerance` is that of a step, as in
    /// [`crate::DEFAULT_TOLERANCE`], 1e-13 to 0.1.
    ///
    /// # Errors
    ///
    /// Returns [`IntegrationError::Tolerance`] if the tolerance lies outside its range.
    pub fn new(
        pump: &'a Pump,
        port: Port,
        legs: impl IntoIterator<IntoIter = M>,
        state: LineState,
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
        Self::new(pump, port, legs, LineState::AT_REST, tolerance)
    }
}

impl<'a, M: Iterator<Item = Leg>, const N: usize> PortRun<'a, M, N, Friction> {
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
        state: LineState,
        tolerance: f64,
    ) -> Result<Self, IntegrationError> {
        Self::resisted(pump, friction, port, legs, state, tolerance)
    }
}

impl<'a, M: Iterator<Item = Leg>, const N: usize, R: Resistance> PortRun<'a, M, N, R> {
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
        state: LineState,
        tolerance: f64,
    ) -> Result<Self, IntegrationError> {
        let mut start = [0.0; N];
        for (place, number) in start.iter_mut().zip(state.numbers()) {
            *place = number;
        }
        let model = Lumped::new(pump.line(port), resistance, port);
        Ok(Self { run: LineRun::new(pump, port, model, legs, start, tolerance)? })
    }

    /// Goes on by [Radau's method](crate::integrator::Radau), which makes fewer and longer steps. Only a line with a
    /// constant R has it.
    ///
    /// # Errors
    ///
    /// Returns [`IntegrationError::NotLinear`] if the resistance is not constant.
    pub fn with_radau(self) -> Result<Self, IntegrationError> {
        Ok(Self { run: self.run.with_radau()? })
    }

    /// Makes one step that ends at `stop_s` at the latest. Returns none once that time is reached.
    ///
    /// # Errors
    ///
    /// Fails if the state is not finite or no step meets the tolerance.
    pub fn step(&mut self, stop_s: f64) -> Result<Option<DenseStep<N>>, IntegrationError> {
        self.run.step(stop_s)
    }

    /// Returns the state at `t_s`. `t_s` must not lie before the last step taken, and the times of later
    /// calls must not fall.
    ///
    /// # Errors
    ///
    /// Fails if the state is not finite or no step meets the tolerance.
    pub fn at(&mut self, t_s: f64) -> Result<LineState, IntegrationError> {
        Ok(line_state(&self.run.at(t_s)?))
    }

    /// Returns the state at `end_s`, with a step that ends there. Later calls start from it.
    ///
    /// # Errors
    ///
    /// Fails if the state is not finite or no step meets the tolerance.
    pub fn run_to(&mut self, end_s: f64) -> Result<LineState, IntegrationError> {
        Ok(line_state(&self.run.run_to(end_s)?))
    }

    /// Returns the smallest and largest pressure from now until `end_s`, kPa absolute.
    ///
    /// # Errors
    ///
    /// Fails if the state is not finite or no step meets the tolerance.
    pub fn extremes(&mut self, end_s: f64) -> Result<Extremes, IntegrationError> {
        self.run.extremes(end_s)
    }

    /// Returns the state reached.
    pub fn state(&self) -> LineState {
        line_state(&self.run.state())
    }

    /// Returns the cost of the integration so far.
    pub fn statistics(&self) -> Statistics {
        self.run.statistics()
    }
}

impl<M: Iterator<Item = Leg>, R: Resistance> PortRun<'_, M, 3, R> {
    /// Returns the state at `t_s` and the volume that has passed the line by then, mL. The times are those of
    /// [`Self::at`].
    ///
    /// # Errors
    ///
    /// Fails if the state is not finite or no step meets the tolerance.
    pub fn passed_at(&mut self, t_s: f64) -> Result<(LineState, f64), IntegrationError> {
        let numbers = self.run.at(t_s)?;
        let [.., volume_ml] = numbers;
        Ok((line_state(&numbers), volume_ml))
    }

    /// Returns the volume that has passed the line up to the time reached, mL.
    pub fn passed_ml(&self) -> f64 {
        let [.., volume_ml] = self.run.state();
        volume_ml
    }
}

/// Returns the line's part of a state.
fn line_state<const N: usize>(numbers: &[f64; N]) -> LineState {
    const { assert!(N >= 2, "pressure and flow come first") };
    LineState::of([numbers[0], numbers[1]])
}
