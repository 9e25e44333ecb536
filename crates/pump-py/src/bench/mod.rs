//! Benches: the compiled half of `pumpmodel.Bench`.

mod balance;
mod bench;
mod by_profile;
mod by_weight;
mod calibration;
mod homing;
mod log;
mod rack;
mod request;
mod safety;
mod schedule;
mod verification;
mod worker;

pub(crate) use balance::Balance;
pub(crate) use bench::Bench;
pub(crate) use rack::Rack;
pub(crate) use schedule::Schedule;
pub(crate) use worker::Call;
