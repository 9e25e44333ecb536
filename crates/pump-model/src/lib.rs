//! First-principles model of a roller-type peristaltic pump: the flow that its rollers make at every angle, and the
//! pressures that this flow makes in the lines.
//!
//! Follows McIntyre, van Schoor, Uren, Kloppers, "Modelling the pulsatile flow rate and pressure response of a
//! roller-type peristaltic pump", Sensors and Actuators A ("flow-centric" model).
//!
//! Units are mL, kPa absolute, s and rad, and stand in every name. Needs neither `std` nor an allocator.
//!
//! Feature `integrator`, on by default: the implicit integrator, for models that are not linear, and the runs made with it.
//! Feature `identification`, on by default: roller volumes from a drawing or from measured points, lines from hoses
//! or from measurements.
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

#[cfg(feature = "identification")]
mod alcohols;
#[cfg(feature = "integrator")]
pub mod circuit;
#[cfg(feature = "identification")]
mod drawing;
#[cfg(feature = "identification")]
mod drawing_fit;
mod error;
mod exact;
mod exact_samples;
mod extremes;
pub mod flow_curve;
#[cfg(feature = "identification")]
mod fluid;
#[cfg(feature = "identification")]
mod friction;
mod geometry;
#[cfg(feature = "identification")]
mod glycerol;
mod hermite;
#[cfg(feature = "identification")]
mod hose;
#[cfg(feature = "identification")]
pub mod identification;
#[cfg(feature = "integrator")]
pub mod integrator;
#[cfg(feature = "identification")]
mod least_squares;
mod line;
pub mod math;
pub mod metrics;
#[cfg(feature = "identification")]
mod monotone_spline;
mod motion;
#[cfg(feature = "integrator")]
mod periodic;
pub mod polynomial;
#[cfg(feature = "integrator")]
mod port_run;
mod presets;
mod propagator;
mod pump;
#[cfg(feature = "identification")]
mod quadrature;
mod ringing;
mod ripple;
#[cfg(feature = "integrator")]
mod roller_centric;
pub mod roller_volume;
mod settling;
#[cfg(feature = "identification")]
mod speed_law;
#[cfg(feature = "identification")]
mod speed_law_flow;
mod steady;
mod stretches;
mod turn_range;
#[cfg(feature = "identification")]
pub mod volume_fit;
mod walk;

#[cfg(feature = "identification")]
pub use drawing::Drawing;
pub use error::ModelError;
pub use exact::ExactRun;
pub use exact_samples::ExactSamples;
pub use extremes::Extremes;
pub use flow_curve::{FlowCurve, Port};
#[cfg(feature = "identification")]
pub use fluid::Fluid;
#[cfg(feature = "identification")]
pub use friction::Friction;
pub use geometry::Geometry;
#[cfg(feature = "identification")]
pub use hose::Hose;
pub use line::Line;
pub use motion::Leg;
#[cfg(feature = "integrator")]
pub use port_run::{DEFAULT_TOLERANCE, PortRun};
pub use presets::{PUBLISHED_CONTACT_ANGLE_DEG, Variant};
pub use pump::Pump;
pub use ripple::Ripple;
#[cfg(feature = "integrator")]
pub use roller_centric::{RollerCentric, RollerRun, RollerSample};
pub use roller_volume::RollerVolume;
pub use settling::SETTLED_ML;
#[cfg(feature = "identification")]
pub use speed_law::SpeedLaw;
#[cfg(feature = "identification")]
pub use speed_law_flow::SpeedLawFlow;
pub use steady::SteadyState;
pub use stretches::{Stretch, Stretches};
#[cfg(feature = "identification")]
pub use volume_fit::{VolumeFit, VolumePoint};
