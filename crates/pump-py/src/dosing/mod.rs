//! Doses planned within the limits of a pump.

mod doser;
mod limits;
mod plan;
mod planning;
mod steps;

pub(crate) use doser::Doser;
pub(crate) use limits::Limits;
pub(crate) use plan::Plan;
