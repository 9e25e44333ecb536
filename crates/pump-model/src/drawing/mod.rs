//! Roller volumes from a drawing or from measured points.

mod append;
pub(crate) mod drawing;
mod drawing_fit;
mod least_squares;
mod monotone_spline;
mod quadrature;
mod smoothing_spline;
pub mod volume_fit;
