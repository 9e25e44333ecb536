//! A line driven by a flow, as a differential equation.

use crate::integrator::{Ode, Options};
use crate::motion::stretches::Stretch;
use crate::port::Port;

use super::line_model::LineModel;
use super::lumped::{Lumped, outward};

/// Flow at the rollers into or out of a line.
pub trait Forcing {
    /// Flow at the rollers at time `t_s`, mL/s, positive from inlet to outlet.
    fn flow_ml_s(&self, t_s: f64) -> f64;
    /// Time derivative of the flow at the rollers, mL/s².
    fn flow_rate_ml_s2(&self, t_s: f64) -> f64;
}

impl Forcing for Stretch {
    // Inlined, so that a derivative that does not need the flow does not compute it.
    #[inline]
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

/// One port of the pump between the rollers and the reservoir: a line and the flow that drives it.
///
/// The circuit follows the model's equation y' = f(s Q(t), y), with s = 1 at the outlet and -1 at the inlet. The
/// derivative over time is df/d(s Q) times s dQ/dt.
#[derive(Debug, Clone, Copy)]
pub struct Circuit<F, L = Lumped> {
    model: L,
    /// s, 1 at the outlet and -1 at the inlet.
    sign: f64,
    /// Q, the flow at the rollers.
    forcing: F,
}

impl<F: Forcing, L> Circuit<F, L> {
    /// Builds the circuit of a line's model at a port.
    pub fn new(model: L, port: Port, forcing: F) -> Self {
        Self { model, sign: outward(port), forcing }
    }
}

impl<F: Forcing, L: LineModel<N>, const N: usize> Ode<N> for Circuit<F, L> {
    fn derivative(&self, t: f64, y: &[f64; N]) -> [f64; N] {
        self.model.derivative(self.sign * self.forcing.flow_ml_s(t), y)
    }

    fn jacobian(&self, t: f64, y: &[f64; N]) -> [[f64; N]; N] {
        self.model.jacobian(self.sign * self.forcing.flow_ml_s(t), y)
    }

    fn time_derivative(&self, t: f64, y: &[f64; N]) -> [f64; N] {
        let inflow_rate = self.sign * self.forcing.flow_rate_ml_s2(t);
        let per_inflow = self.model.per_inflow(self.sign * self.forcing.flow_ml_s(t), y);
        per_inflow.map(|change| change * inflow_rate)
    }
}

/// Returns the errors allowed in a step of a [`Circuit`].
///
/// A state may err by `tolerance` times the sum of its magnitude and of `scale_kpa` times its
/// [scale](LineModel::scale). A [total](LineModel::totals) has no part relative to itself. Nothing is
/// checked; [`crate::integrator::Rodas5p::new`] does.
pub fn options<const N: usize>(model: &impl LineModel<N>, tolerance: f64, scale_kpa: f64) -> Options<N> {
    let mut options = Options::equal(tolerance);
    options.absolute = model.scale().map(|scale| tolerance * scale_kpa * scale);
    for (relative, total) in options.relative.iter_mut().zip(model.totals()) {
        if total {
            *relative = 0.0;
        }
    }
    options
}
