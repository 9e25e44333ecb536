//! Calibrations: weighed runs, and the correction of doses that follows from them.

mod calibration;
mod weighed;

pub(crate) use calibration::Calibration;
pub(crate) use weighed::{_reading, fit_named, reading_ml, runs_of};
