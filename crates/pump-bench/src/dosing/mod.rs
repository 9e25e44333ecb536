//! One dose: what is asked, what is planned and predicted, and how sure it is.

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

pub use error::DoseError;
pub use prepared::Prepared;
pub use request::DoseRequest;
pub use retraction::Retraction;
pub use schedule::{Action, MAX_DOSES, Missed, Schedule, ScheduleError};
pub(crate) use tube_life::TubeLife;
pub use uncertainty::{Budget, COVERAGE_FACTOR, Share, ShareSource};
