//! Doses: their reports, their limits, their files and every way in which they end.

mod batches;
mod endings;
mod files;
mod finish;
mod fluids;
mod limits;
mod nozzle;
mod profiles;
mod reports;
mod retraction;
#[cfg(unix)]
mod runs;
mod speed_law;
mod stated_angle;
mod unknown_angle;
