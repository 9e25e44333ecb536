//! Control of a roller-type peristaltic pump from the angle of its rollers.
//!
//! This crate computes the angle that gives a volume, the speed, the time of each step, and the pressures to
//! expect. Units are mL, kPa absolute, s and rad, and stand in every name. The crate needs neither `std` nor
//! an allocator. It does no I/O and reads no clock.
//!
//! ```
//! use pump_ctl::plan::{Cruise, Doser, Limits, Motor, Phase, Request};
//! use pump_model::Pump;
//!
//! let pump = Pump::three_roller();
//! let motor = Motor::new(12_800.0, 17.8, 500.0);
//! let request = Request::new(25.0, Cruise::Flow { ml_s: 5.0 });
//! let plan = Doser::new(&pump, Limits::new(motor))?.plan(Phase::known(0.0), &request)?;
//! assert_eq!(plan.steps(), 15_480);
//! assert!((plan.planned_ml() - 25.0).abs() < 0.001);
//! # Ok::<(), pump_ctl::plan::PlanError>(())
//! ```
#![cfg_attr(docsrs, feature(doc_cfg))]
#![no_std]

pub mod drive;
#[doc(hidden)]
pub mod generated;
mod parameter;
pub mod plan;
pub mod step;

pub use parameter::Parameter;

#[cfg(doctest)]
#[doc = include_str!("../../../docs/embedding.md")]
struct Embedding;
