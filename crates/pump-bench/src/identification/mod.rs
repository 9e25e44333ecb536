//! Lines identified from tables of measurements: reading, fitting and reporting.

mod identified;
mod joint;
mod nozzle;
mod points;
mod pressure_record;
mod tables;
mod thinned;

pub use identified::{Identified, Parameter};
pub use joint::{JointlyIdentified, JointlyRecorded, PressureRecord, identified_jointly_while};
pub use nozzle::Nozzle;
pub use points::{identified_compliance, identified_resistance};
pub use pressure_record::{Begin, Turning, identified_line, identified_line_while};
pub use tables::{Waveforms, flow_points_of_csv, injection_of_csv, waveforms_of_csv};

/// Pearson's correlation below which a fit gets a warning, since half of the variance is then left over.
/// McIntyre et al. report more above 50 r/min (Section 5.2).
const WEAK_PEARSON: f64 = 0.7;
