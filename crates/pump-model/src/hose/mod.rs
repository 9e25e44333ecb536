//! Lines from hoses and fluids.

mod alcohols;
pub(crate) mod fluid;
mod glycerol;
pub(crate) mod hose;
