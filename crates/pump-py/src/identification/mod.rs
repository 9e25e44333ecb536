//! Lines from measurements, their likelihood, and measures of how well a model meets a measurement.

mod answer;
mod column;
mod compliance;
mod joint;
mod likelihood;
mod metrics;
mod points;
mod resistance;
mod waveform;

pub(crate) use compliance::_identify_compliance;
pub(crate) use joint::_identify_line_jointly;
pub(crate) use likelihood::LineLikelihood;
pub(crate) use metrics::{nrmse, pearson, rmse};
pub(crate) use resistance::_identify_resistance;
pub(crate) use waveform::{_identify_line, BEGINS, PARAMETERS};
