//! The reports of doses, benches, calibrations and runs: JSON for programs, words for people.

mod calibration;
mod choices;
mod config;
mod dose;
mod dose_details;
mod dose_text;
mod ending;
mod error;
mod identified;
mod log;
mod phase;
mod pump_check;
mod rotor;
mod simulation;
mod sizing;
mod status;
mod status_text;
mod tube;
mod verification;

pub use crate::dosing::{RippleAt, RippleReport};
pub use crate::notice::Remedy;
pub use crate::notice::with_sources;
pub use calibration::{calibration_json, calibration_text, calibrations_json, calibrations_text};
pub use choices::{Format, VolumeBasis};
pub use config::{ShownConfig, ShownPump, ShownRack};
pub use dose::{ByWeightReport, CalibrationReport, DoseReport, PhaseReport, ProfileReport, RunReport, Until};
pub use ending::Ending;
pub use error::{ErrorFacts, ErrorKind, ErrorReport, Explain};
pub use log::{LOG_CSV_HEADER, LeftOut, LogPlace, LogSpan, LogTotal, LogTotals, log_csv, log_json, log_text};
pub use phase::{phase_json, phase_text};
pub use pump_check::pump_check;
pub use rotor::{AcceptedReport, accepted_text, carry_dropped_text, rotor_text};
pub use simulation::{SimulationReport, cavitation_warning};
pub use sizing::{sizing_json, sizing_text, sizing_title};
pub use status::{
    BoardStatus, CalibrationStatus, LastByWeight, SafetyStatus, StandStatus, Status, StatusRow,
    UnfinishedCalibration, UnfinishedStatus,
};
pub use tube::{TubeCalibration, TubeReport};
