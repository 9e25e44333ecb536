//! Nonlinear least squares after Levenberg and Marquardt, for residuals that come one by one.

use crate::error::ModelError;

use super::triangle::Triangle;

/// Steps that a search may take; it takes about ten.
pub(super) const MOST_STEPS: u32 = 100;

/// A fit is done when what a step could still gain is this part of what is left, or the step is this small in every
/// parameter.
const GAIN: f64 = 1e-12;
const STEP: f64 = 1e-9;

/// A model with N parameters, some of them held.
pub(super) trait Residuals<const N: usize> {
    /// Sum of squares of the residuals; an error where there is no model.
    fn sum(&self, at: &[f64; N]) -> Result<f64, ModelError>;

    /// A row for every residual: by how much the model rises with each parameter, and the residual, measured less
    /// model.
    fn rows(&self, at: &[f64; N]) -> Result<Triangle<N>, ModelError>;
}

/// Where a search ended.
#[derive(Debug, Clone, Copy)]
pub(super) struct Found<const N: usize> {
    pub(super) at: [f64; N],
    /// Sum of squares there.
    pub(super) sum: f64,
    /// The rows there.
    pub(super) rows: Triangle<N>,
    /// How many steps it took; [`MOST_STEPS`] if it did not converge.
    pub(super) steps: u32,
}

/// Goes downhill from `at`: steps by linear least squares with a damping row for every parameter, as long as its column
/// (Marquardt, J. SIAM 11, 1963; the damping moves by tens).
pub(super) fn search<const N: usize>(
    model: &impl Residuals<N>,
    at: [f64; N],
) -> Result<Found<N>, ModelError> {
    let (mut sum, mut rows) = (model.sum(&at)?, model.rows(&at)?);
    let (mut at, mut damping) = (at, 1e-3);
    for steps in 0..MOST_STEPS {
        let done = Found { at, sum, rows, steps };
        if rows.gained() <= GAIN * sum {
            return Ok(done);
        }
        let mut damped = rows;
        for (n, length) in rows.lengths().into_iter().enumerate() {
            // A parameter without effect stays where it is; the caller sees that it has none.
            let length = if length > 0.0 { length } else { 1.0 };
            damped.push(core::array::from_fn(|k| if k == n { damping * length } else { 0.0 }), 0.0);
        }
        let Some(step) = damped.solution() else { break };
        let small = step.iter().all(|step| step.abs() < STEP);
        let next = core::array::from_fn(|n| at[n] + step[n]);
        // Steps to lines that cannot be, or to their border, are refused like steps uphill.
        let downhill = model.sum(&next).ok().filter(|next_sum| *next_sum <= sum);
        match downhill.and_then(|next_sum| Some((next_sum, model.rows(&next).ok()?))) {
            Some((next_sum, next_rows)) => {
                (at, sum, rows) = (next, next_sum, next_rows);
                damping = (0.1 * damping).max(1e-9);
            }
            None => damping *= 10.0,
        }
        if small {
            return Ok(Found { at, sum, rows, steps });
        }
    }
    Ok(Found { at, sum, rows, steps: MOST_STEPS })
}
