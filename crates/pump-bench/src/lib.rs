//! Doses with a peristaltic pump, whose flow is computed from the angle of its rollers.
//!
//! A pump file describes the pump, a [`Bench`] drives it and a [`DoseReport`] tells what a dose did. The
//! command `dose` is a thin shell around this library. Other programs may use the library in the same way.
//!
//! ```
//! use std::ops::ControlFlow;
//!
//! use pump_bench::{Bench, DoseReport, DoseRequest, built_in};
//!
//! let state = tempfile::tempdir()?;
//! let bench = Bench::new(built_in("three-roller").unwrap(), None, state.path())?;
//! let mut session = bench.session()?;
//! let prepared = session.prepare(DoseRequest::dose(25.0))?;
//! let delivered = session.run(&prepared, |_steps| ControlFlow::Continue(()))?;
//! let report = DoseReport::new(&bench, &prepared, Some(&delivered));
//! assert!(delivered.completed && (delivered.volume_ml - 25.0).abs() < 0.002);
//! assert!((report.expanded_uncertainty_ml - 1.38).abs() < 0.01);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # In a service
//!
//! A service gives each pump a thread. A [`Bench`] is `Send` and `Sync`. A [`Session`] is `Send`, and it borrows its
//! bench: move the bench into the thread and open the session there. Orders and answers go through channels. Errors
//! are `Send` and `Sync`, and their texts name no command. A dose stops when the closure that is given to
//! [`Session::run`] returns `Break`, as another thread may have asked for.
//!
//! ```
//! use std::ops::ControlFlow;
//! use std::sync::mpsc::channel;
//! use std::thread;
//!
//! use pump_bench::{Bench, DoseError, DoseRequest, built_in};
//!
//! let state = tempfile::tempdir()?;
//! let bench = Bench::new(built_in("three-roller").unwrap(), None, state.path())?;
//! let (orders, received) = channel::<DoseRequest>();
//! let (answers, delivered) = channel();
//! let pump = thread::spawn(move || -> Result<(), DoseError> {
//!     let mut session = bench.session()?;
//!     for request in received {
//!         let prepared = session.prepare(request)?;
//!         let dose = session.run(&prepared, |_steps| ControlFlow::Continue(()))?;
//!         if answers.send(dose.volume_ml).is_err() {
//!             break;
//!         }
//!     }
//!     Ok(())
//! });
//! orders.send(DoseRequest::dose(5.0))?;
//! orders.send(DoseRequest::dose(2.0))?;
//! drop(orders);
//! let volumes_ml: Vec<f64> = delivered.iter().collect();
//! pump.join().expect("the thread does not panic")?;
//! assert!((volumes_ml[0] - 5.0).abs() < 0.002 && (volumes_ml[1] - 2.0).abs() < 0.002);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![cfg_attr(docsrs, feature(doc_cfg))]

pub mod balance;
mod bench;
pub mod calibration;
pub mod catalogue;
pub mod config;
mod cut_text;
pub mod displacement;
pub mod dosing;
pub mod drives;
pub mod export;
pub mod files;
pub mod heads;
pub mod identification;
pub mod notice;
mod numbers;
pub mod pump_file;
pub mod rack;
pub mod record;
pub mod report;
pub mod safety;
#[cfg(test)]
mod sampling;
pub mod setup;
pub mod shell;
pub mod simulation;
pub mod sizing;
pub mod units;
pub mod words;

pub use bench::{
    Accepted, AngleSet, Bench, Cleared, Delivered, DeliveredByWeight, LogReading, NewTube, OrderByWeight,
    PreparedByWeight, PreparedProfile, Rehearsal, SeriesMotion, SeriesRequest, Session, TimedVolume,
    ToleranceBy, head_print,
};
pub use catalogue::{built_in, pump_named};
pub use dosing::{DoseError, DoseRequest, Prepared};
pub use pump_file::PumpFile;
pub use report::DoseReport;

#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;
