//! Control of a roller-type peristaltic pump from the angle of its rollers.
//!
//! This crate computes the angle that gives a volume, the speed, the time of each step, and the pressures to
//! expect. Units are mL, kPa absolute, s and rad, and stand in every name. The crate needs neither `std` nor
//! an allocator. It does no I/O and reads no clock.
//!
//! ```
//! use pump_ctl::plan::{Cruise, Limits, Motor, Phase, Request, plan};
//! use pump_model::Pump;
//!
//! let pump = Pump::three_roller();
//! let motor = Motor { steps_per_rev: 12_800.0, max_speed_rad_s: 17.8, max_acceleration_rad_s2: 500.0 };
//! let request = Request::new(25.0, Cruise::Flow { ml_s: 5.0 });
//! let plan = plan(&pump, Phase::known(0.0), &request, &Limits::of_motor(motor))?;
//! assert_eq!(plan.steps, 15_480);
//! assert!((plan.planned_ml - 25.0).abs() < 0.001);
//! # Ok::<(), pump_ctl::plan::PlanError>(())
//! ```
#![no_std]

pub mod drive;
pub mod plan;
pub mod step;

#[cfg(doctest)]
#[doc = include_str!("../../../docs/embedding.md")]
struct Embedding;
