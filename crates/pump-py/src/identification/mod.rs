//! Lines from measurements, and measures of how well a model meets a measurement.

mod answer;
mod column;
mod compliance;
mod metrics;
mod port;
mod resistance;
mod waveform;

pub(crate) use compliance::_identify_compliance;
pub(crate) use metrics::{nrmse, pearson, rmse};
pub(crate) use port::PORTS;
pub(crate) use resistance::_identify_resistance;
pub(crate) use waveform::{_identify_line, BEGINS, PARAMETERS};
