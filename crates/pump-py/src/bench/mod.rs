//! Benches: the compiled half of `pumpmodel.Bench`.

mod bench;
mod calibration;
mod homing;
mod request;
mod schedule;
mod verification;
mod worker;

pub(crate) use bench::Bench;
pub(crate) use schedule::Schedule;
