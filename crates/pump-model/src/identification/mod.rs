//! Lines from measurements: R from flows and pressures, C from an injection, L (and R, C) from a waveform, each with
//! how sure it is.

mod autocorrelation;
mod compliance;
mod error;
mod estimate;
mod joint;
pub mod least_squares;
mod line_fit;
mod readings;
mod recording;
mod resistance;
mod sought;
mod sought_parameter;
mod student;
mod watch;
mod waveform;

pub use compliance::{ComplianceFit, InjectionPoint};
pub use error::IdentificationError;
pub use estimate::Estimate;
pub use joint::{JointFit, JointRecording, RecordingFit};
pub use line_fit::LineFit;
pub use readings::Readings;
pub use recording::{PressureSample, Recording, RotorMotion};
pub use resistance::{Bend, FlowPoint, ResistanceFit};
pub use sought::Sought;
pub use sought_parameter::SoughtParameter;
pub use student::widening;
