//! One dose: its request, its plan and prediction, and its uncertainty.

#[cfg(test)]
mod coverage;
mod error;
mod planner;
mod prepared;
mod request;
mod retraction;
mod schedule;
mod tube_life;
mod uncertainty;
mod unknown_angle;
mod warnings;

pub use error::DoseError;
pub use prepared::Prepared;
pub use request::DoseRequest;
pub use retraction::Retraction;
pub use schedule::{Action, MAX_DOSES, Missed, Schedule, ScheduleError};
pub(crate) use tube_life::TubeLife;
pub use uncertainty::{Budget, COVERAGE_FACTOR, Share, ShareSource};
