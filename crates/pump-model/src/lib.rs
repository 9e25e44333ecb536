//! First-principles model of a roller-type peristaltic pump: the flow that its rollers make at every angle, and the
//! pressures that this flow makes in the lines.
//!
//! Follows McIntyre, van Schoor, Uren, Kloppers, "Modelling the pulsatile flow rate and pressure response of a
//! roller-type peristaltic pump", Sensors and Actuators A ("flow-centric" model).
//!
//! Units are mL, kPa absolute, s and rad, and stand in every name. Needs neither `std` nor an allocator.
//!
//! Feature `integrator`, on by default: the implicit integrator, for models that are not linear, and the runs made with it.
//! Everything else links into firmware without a panic (`tests/no_panic`).
//!
//! ```
//! use pump_model::Pump;
//! let pump = Pump::three_roller();
//! // A third of a turn delivers 7.1 mL from any angle; what a tenth of a turn delivers depends on the angle.
//! let from = |angle| pump.outlet_curve().volume_ml(angle + 0.6283) - pump.outlet_curve().volume_ml(angle);
//! assert!((from(0.2) - 0.8492).abs() < 1e-3 && (from(1.2) - 2.7634).abs() < 1e-3);
//! ```
#![no_std]

#[cfg(feature = "integrator")]
pub mod circuit;
mod error;
mod exact;
mod exact_samples;
mod extremes;
pub mod flow_curve;
mod geometry;
mod hermite;
#[cfg(feature = "integrator")]
pub mod integrator;
mod line;
pub mod math;
mod motion;
pub mod polynomial;
#[cfg(feature = "integrator")]
mod port_run;
mod presets;
mod propagator;
mod pump;
mod ripple;
pub mod roller_volume;
mod settling;
mod steady;
mod stretches;
mod turn_range;

pub use error::ModelError;
pub use exact::ExactRun;
pub use exact_samples::ExactSamples;
pub use extremes::Extremes;
pub use flow_curve::{FlowCurve, Port};
pub use geometry::Geometry;
pub use line::Line;
pub use motion::Leg;
#[cfg(feature = "integrator")]
pub use port_run::{DEFAULT_TOLERANCE, PortRun};
pub use presets::{PUBLISHED_CONTACT_ANGLE_DEG, Variant};
pub use pump::Pump;
pub use ripple::Ripple;
pub use roller_volume::RollerVolume;
pub use settling::SETTLED_ML;
pub use steady::SteadyState;
pub use stretches::{Stretch, Stretches};
