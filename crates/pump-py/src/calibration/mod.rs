//! Calibrations: weighed runs, and the correction of doses that follows from them.

mod calibration;
mod weighed;

pub(crate) use calibration::Calibration;
pub(crate) use weighed::{_reading, expected_of, fit_named, reading_ml, runs_of, scale_of};
