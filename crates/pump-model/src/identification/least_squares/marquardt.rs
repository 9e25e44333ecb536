//! Nonlinear least squares after Levenberg and Marquardt, for residuals that come one by one.

use libm::sqrt;

use crate::error::ModelError;

use super::triangle::Triangle;

/// Steps that a search may take; it takes about ten.
pub(in super::super) const MOST_STEPS: u32 = 200;

/// Part of the sum of squares: a search ends where a step could gain less.
pub(in super::super) const GAIN: f64 = 1e-14;

/// Change of a parameter: a search ends where a step changes every parameter by less.
pub(in super::super) const STEP: f64 = 1e-10;

/// Measurements and a model with N parameters, some of them held.
pub trait Residuals<const N: usize> {
    /// Returns the sum of squares of the residuals.
    ///
    /// # Errors
    ///
    /// [`ModelError`] where the parameters give no model.
    fn sum(&self, at: &[f64; N]) -> Result<f64, ModelError>;

    /// Returns a row for every residual: the slope of the model with each parameter, and the residual,
    /// measured less model.
    ///
    /// # Errors
    ///
    /// [`ModelError`] where the parameters, or those beside them, give no model.
    fn rows(&self, at: &[f64; N]) -> Result<Triangle<N>, ModelError>;
}

/// End of a search.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub struct Found<const N: usize> {
    /// Parameters where the search ended.
    pub at: [f64; N],
    /// Sum of squares of the residuals there.
    pub sum: f64,
    /// Rows of the residuals there.
    pub rows: Triangle<N>,
    /// Number of steps that the search took; 200, the most that it may take, if it did not converge.
    pub steps: u32,
    /// Error of the last step that was refused because its parameters give no model.
    pub refused: Option<ModelError>,
}

impl<const N: usize> Found<N> {
    /// True if the search reached a minimum.
    pub fn converged(&self) -> bool {
        self.steps < MOST_STEPS
    }
}

/// Searches the least sum of squares downhill from `at`. Each step is one of linear least squares with a
/// damping row for every parameter, as long as its column (Marquardt, J. SIAM 11, 1963; the damping moves by
/// tens).
///
/// The search refuses steps to parameters that give no model, as it refuses steps uphill.
///
/// ```
/// use pump_model::ModelError;
/// use pump_model::identification::least_squares::{Residuals, Triangle, search};
///
/// /// y = exp(-k t).
/// struct Decay([(f64, f64); 3]);
///
/// impl Residuals<1> for Decay {
///     fn sum(&self, [k]: &[f64; 1]) -> Result<f64, ModelError> {
///         Ok(self.0.iter().map(|(t, y)| (y - (-k * t).exp()).powi(2)).sum())
///     }
///
///     fn rows(&self, [k]: &[f64; 1]) -> Result<Triangle<1>, ModelError> {
///         let mut rows = Triangle::new();
///         for (t, y) in &self.0 {
///             rows.push([-t * (-k * t).exp()], y - (-k * t).exp());
///         }
///         Ok(rows)
///     }
/// }
///
/// let found = search(&Decay([(1.0, 0.5), (2.0, 0.25), (3.0, 0.125)]), [2.0])?;
/// assert!(found.converged() && (found.at[0] - 2.0_f64.ln()).abs() < 1e-9);
/// # Ok::<(), ModelError>(())
/// ```
///
/// # Errors
///
/// [`ModelError`] where `at` gives no model.
pub fn search<const N: usize>(model: &impl Residuals<N>, at: [f64; N]) -> Result<Found<N>, ModelError> {
    let (mut sum, mut rows) = (model.sum(&at)?, model.rows(&at)?);
    let (mut at, mut damping, mut refused) = (at, 1e-3, None);
    for steps in 0..MOST_STEPS {
        if rows.gained() <= GAIN * sum {
            return Ok(Found { at, sum, rows, steps, refused });
        }
        let mut damped = rows;
        for (n, length) in rows.lengths().into_iter().enumerate() {
            // A parameter without effect stays where it is; the caller sees that it has none.
            let length = if length > 0.0 { length } else { 1.0 };
            damped.push(core::array::from_fn(|k| if k == n { sqrt(damping) * length } else { 0.0 }), 0.0);
        }
        let Some(step) = damped.solution() else { break };
        let small = step.iter().all(|step| step.abs() < STEP);
        let next = core::array::from_fn(|n| at[n] + step[n]);
        // Steps to models that cannot be, or to their border, are refused like steps uphill.
        let stepped = match model.sum(&next) {
            Ok(next_sum) if next_sum <= sum => model.rows(&next).map(|next_rows| Some((next_sum, next_rows))),
            Ok(_) => Ok(None),
            Err(error) => Err(error),
        };
        match stepped {
            Ok(Some((next_sum, next_rows))) => {
                // Where the model has corners, what a step gains may be nothing though the slopes promise more.
                let done = sum - next_sum <= GAIN * sum;
                (at, sum, rows) = (next, next_sum, next_rows);
                if done {
                    return Ok(Found { at, sum, rows, steps, refused });
                }
                damping = (0.1 * damping).max(1e-12);
            }
            Ok(None) => damping *= 10.0,
            Err(error) => {
                refused = Some(error);
                damping *= 10.0;
            }
        }
        if small {
            return Ok(Found { at, sum, rows, steps, refused });
        }
    }
    Ok(Found { at, sum, rows, steps: MOST_STEPS, refused })
}
