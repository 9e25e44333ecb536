//! Doses with a peristaltic pump whose flow is computed from the angle of its rollers: pump files, benches, reports.
//! The command `dose` is a thin shell around this library, and other programs may be too.
//!
//! ```
//! use std::ops::ControlFlow;
//!
//! use pump_dose::{Bench, DoseReport, DoseRequest, built_in};
//!
//! let state = tempfile::tempdir()?;
//! let bench = Bench::new(built_in("three-roller").unwrap(), None, state.path())?;
//! let mut session = bench.session()?;
//! let prepared = session.prepare(DoseRequest::dose(25.0))?;
//! let delivered = session.run(&prepared, |_steps| ControlFlow::Continue(()))?;
//! let report = DoseReport::new(&bench, &prepared, Some(&delivered));
//! assert!(delivered.completed && (delivered.volume_ml - 25.0).abs() < 0.002);
//! assert!((report.expanded_uncertainty_ml - 1.22).abs() < 0.01);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod batch;
mod bench;
mod built_in;
pub mod calibration;
pub mod chart;
pub mod csv;
mod dose;
mod drawn_pump;
pub mod drivers;
mod error;
pub mod fit_plot;
mod folder;
pub mod identification;
pub mod journal;
mod output;
pub mod plot;
pub mod pump_file;
pub mod quantity;
mod report;
mod report_text;
mod retraction;
mod roller_runs;
pub mod rust_source;
pub mod sample;
#[cfg(test)]
mod sampling;
mod session;
mod simulation;
pub mod speed_law;
mod status;
mod table;
pub mod times;
mod tube;
mod uncertainty;
mod unknown_angle;
pub mod waveform;

pub use bench::Bench;
pub use built_in::{BUILT_IN, built_in, pump_named};
pub use dose::{DoseRequest, PhaseSource, Prepared, Purpose};
pub use drawn_pump::DrawnPump;
pub use drivers::{
    Abilities, Disturbance, Drive, DriveError, DriveFault, DriveLimits, Gate, Grbl, GrblError, Sim, Sought,
};
pub use error::DoseError;
pub use folder::{Folder, FolderError, Lock, default_state_dir};
pub use output::Staged;
pub use report::{CalibrationReport, DoseReport, PhaseReport};
pub use retraction::Retraction;
pub use roller_runs::{Fall, RollerRuns};
pub use session::{AngleSet, Delivered, NewTube, Session};
pub use simulation::{AskedMethod, MAX_SAMPLES, MethodError, Simulation, SteadyReport, choose_method};
pub use status::{Status, UnfinishedStatus};
pub use table::TableError;
pub use uncertainty::{Budget, COVERAGE_FACTOR, Share};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
