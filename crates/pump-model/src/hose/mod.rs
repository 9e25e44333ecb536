//! Lines from hoses and fluids.

mod alcohols;
pub(crate) mod falling_drop;
pub(crate) mod fluid;
mod glycerol;
pub(crate) mod hose;
mod surface_tension;
