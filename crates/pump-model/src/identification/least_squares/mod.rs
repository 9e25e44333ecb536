//! Least squares: rows one by one, Levenberg and Marquardt's search, and a straight line.

mod marquardt;
mod straight_line;
mod triangle;

pub use marquardt::{Found, Residuals, search};
pub(super) use marquardt::{GAIN, MOST_STEPS, STEP};
pub use straight_line::{EstimatedLine, StraightLine, Term, Terms};
pub use triangle::Triangle;
