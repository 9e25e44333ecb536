//! The requests of programs, below `/api/v1`.

pub(super) mod calibrations;
pub(super) mod inputs;
pub(super) mod log;
pub(super) mod orders;
mod origins;
pub(super) mod pumps;
pub(super) mod schedule;
