//! Lines between the rollers and the reservoirs, and the hoses that they follow from.

mod hose;
mod line;
mod linear;

pub(crate) use hose::{_fluid_check, _fluid_water, _hose_drop, _hose_line, _hose_reynolds, _hose_volume};
pub(crate) use line::{Line, named, optional_line};
