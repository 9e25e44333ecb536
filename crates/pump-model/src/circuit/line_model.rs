//! Models of a line: the equations between the rollers and the reservoir.

/// Model of the line of one port, with `N` states.
///
/// State 0 is the pressure at the rollers above the reservoir, kPa. The other states are the model's own.
/// The inflow is the flow from the rollers into the line, mL/s: it is negative where the rollers draw from
/// the line, as they do at the inlet of a pump that runs forward. So one model serves both ports.
///
/// A [`super::LineRun`] integrates a model over a motion, and [`crate::Pump::periodic_line`] finds its periodic
/// state.
///
/// A line with a vent at the port, which leaks G p:
///
/// ```
/// use pump_model::circuit::{LineModel, LineRun};
/// use pump_model::{DEFAULT_TOLERANCE, Leg, Line, Port, Pump};
///
/// /// C dp/dt = Q - q - G p, L dq/dt = p - R q. The states are p and q.
/// struct Vented {
///     line: Line,
///     leak_ml_s_kpa: f64,
/// }
///
/// impl LineModel<2> for Vented {
///     fn derivative(&self, inflow_ml_s: f64, [p, q]: &[f64; 2]) -> [f64; 2] {
///         let rate = (inflow_ml_s - q - self.leak_ml_s_kpa * p) / self.line.compliance_ml_kpa;
///         [rate, (p - self.line.resistance_kpa_s_ml * q) / self.line.inertance_kpa_s2_ml]
///     }
///     fn jacobian(&self, _inflow_ml_s: f64, _state: &[f64; 2]) -> [[f64; 2]; 2] {
///         let [per_c, per_l] = [self.line.compliance_ml_kpa, self.line.inertance_kpa_s2_ml].map(f64::recip);
///         [[-self.leak_ml_s_kpa * per_c, -per_c], [per_l, -self.line.resistance_kpa_s_ml * per_l]]
///     }
///     fn per_inflow(&self, _inflow_ml_s: f64, _state: &[f64; 2]) -> [f64; 2] {
///         [1.0 / self.line.compliance_ml_kpa, 0.0]
///     }
///     fn scale(&self) -> [f64; 2] {
///         [1.0, (self.line.compliance_ml_kpa / self.line.inertance_kpa_s2_ml).sqrt()]
///     }
/// }
///
/// let pump = Pump::three_roller();
/// let swing_kpa = |leak_ml_s_kpa| {
///     let model = Vented { line: Line::PUBLISHED, leak_ml_s_kpa };
///     let motion = [Leg::constant_speed(0.0, 10.0)];
///     let mut run = LineRun::new(&pump, Port::Outlet, model, motion, [0.0; 2], DEFAULT_TOLERANCE)?;
///     let extremes = run.extremes(3.0)?;
///     Ok::<f64, pump_model::IntegrationError>(extremes.max_kpa - extremes.min_kpa)
/// };
/// assert!(swing_kpa(0.5)? < 0.8 * swing_kpa(0.0)?);
/// # Ok::<(), pump_model::IntegrationError>(())
/// ```
pub trait LineModel<const N: usize> {
    /// Returns the derivative of the states over time, in their units per second.
    fn derivative(&self, inflow_ml_s: f64, state: &[f64; N]) -> [f64; N];
    /// Returns the Jacobian by rows: entry `[i][j]` is the derivative of state i's derivative over state j.
    fn jacobian(&self, inflow_ml_s: f64, state: &[f64; N]) -> [[f64; N]; N];
    /// Returns the derivative of [`Self::derivative`] over the inflow. Times the slope of the inflow it is the
    /// derivative over time that the integrator needs.
    fn per_inflow(&self, inflow_ml_s: f64, state: &[f64; N]) -> [f64; N];
    /// Returns the change of each state that weighs as much as 1 kPa at the rollers, in the state's unit. Each
    /// is positive, and that of state 0 is 1. A flow that carries the same energy is sqrt(C/L) mL/s.
    fn scale(&self) -> [f64; N];
    /// Returns true for each state that only adds up, as a volume that has passed does. Its error is that of
    /// what it adds up, and it need not repeat in a periodic state. No state adds up unless a model says so.
    fn totals(&self) -> [bool; N] {
        [false; N]
    }
    /// Returns true if the derivative is a constant matrix times the states plus what the inflow alone decides, with
    /// one matrix for all inflows and states. A linear model can be integrated in longer steps
    /// ([`super::LineRun::with_radau`]). No model is linear unless it says so.
    fn is_linear(&self) -> bool {
        false
    }
}

impl<const N: usize, L: LineModel<N> + ?Sized> LineModel<N> for &L {
    fn derivative(&self, inflow_ml_s: f64, state: &[f64; N]) -> [f64; N] {
        (**self).derivative(inflow_ml_s, state)
    }
    fn jacobian(&self, inflow_ml_s: f64, state: &[f64; N]) -> [[f64; N]; N] {
        (**self).jacobian(inflow_ml_s, state)
    }
    fn per_inflow(&self, inflow_ml_s: f64, state: &[f64; N]) -> [f64; N] {
        (**self).per_inflow(inflow_ml_s, state)
    }
    fn scale(&self) -> [f64; N] {
        (**self).scale()
    }
    fn totals(&self) -> [bool; N] {
        (**self).totals()
    }
    fn is_linear(&self) -> bool {
        (**self).is_linear()
    }
}
