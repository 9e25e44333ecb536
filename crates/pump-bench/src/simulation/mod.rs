//! Waveforms: flows, pressures and the delivered volume over time.

mod fastest;
mod range;
mod reached;
mod sample;
mod sensitivity;
mod simulation;
mod start;
mod times;
mod waveform;

pub use fastest::{FastestRun, fastest_run};
pub use range::Course;
pub(crate) use reached::Reached;
pub(crate) use sample::Columns;
pub use sample::{COLUMNS, Sample};
pub use sensitivity::{Derivatives, SensitiveWaveform, steady_sensitivities};
pub use simulation::{AskedMethod, MethodError, ModelName, Simulation, SteadyReport, choose_method};
pub use times::{EqualTimes, interval_s, times};
pub use waveform::{Integration, Method, Waveform};
