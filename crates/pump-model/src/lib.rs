//! First-principles model of a roller-type peristaltic pump: the flow that its rollers make at every angle,
//! and the pressures that this flow makes in the lines.
//!
//! The crate follows McIntyre, van Schoor, Uren, Kloppers, "Modelling the pulsatile flow rate and pressure
//! response of a roller-type peristaltic pump", Sensors and Actuators A ("flow-centric" model).
//!
//! Units are mL, kPa absolute, s and rad, and stand in every name. The crate needs neither `std` nor an
//! allocator.
//!
//! Every transcendental function is `libm`'s. With libm 0.2.16, x86_64 Linux and `thumbv7em-none-eabihf`
//! compute the same bits: a test compares a plan of an emulated Cortex-M4 with the host's. Other versions and
//! targets are not compared.
//!
//! A feature gates rooms, and none is on by default:
//!
//! - `integrator`: the implicit integrator for nonlinear models, the runs made with it, and lines of one's own.
//! - `construction`: roller volumes from a drawing or from measured points, lines from hoses and fluids.
//! - `sensitivity`: runs with their exact derivatives.
//! - `identification`: lines from measurements. It brings the derivatives.
//! - `experimental`: the roller-centric model and the speed law. It brings the first two.
//! - `serde` and `defmt`: those crates' traits, without an allocator.
//!
//! All other rooms link into firmware without a panic (`tests/no_panic`).
//!
//! ```
//! use pump_model::Pump;
//! let pump = Pump::three_roller();
//! // A third of a turn delivers 7.1 mL from any angle; the volume of a tenth of a turn depends on the angle.
//! let from = |angle| pump.outlet_curve().volume_ml(angle + 0.6283) - pump.outlet_curve().volume_ml(angle);
//! assert!((from(0.2) - 0.8492).abs() < 1e-3 && (from(1.2) - 2.7634).abs() < 1e-3);
//! ```
#![cfg_attr(docsrs, feature(doc_cfg))]
#![no_std]

#[cfg(feature = "integrator")]
pub mod circuit;
#[cfg(feature = "construction")]
mod drawing;
mod error;
#[cfg(feature = "experimental")]
mod experimental;
#[doc(hidden)]
pub mod generated;
mod head;
#[cfg(feature = "construction")]
mod hose;
#[cfg(feature = "identification")]
pub mod identification;
#[cfg(feature = "integrator")]
pub mod integrator;
mod line;
mod math;
mod motion;
mod port;
mod pump;
#[cfg(feature = "sensitivity")]
mod sensitivity;
pub mod units;
mod work;

#[cfg(feature = "integrator")]
pub use circuit::line_run::DEFAULT_TOLERANCE;
#[cfg(feature = "integrator")]
pub use circuit::port_run::PortRun;
#[cfg(feature = "construction")]
pub use drawing::drawing::Drawing;
#[cfg(feature = "construction")]
pub use drawing::volume_fit::{self, VolumeFit, VolumePoint};
pub use error::{Allowed, IntegrationError, ModelError, Parameter, Shown};
#[cfg(feature = "experimental")]
pub use experimental::roller_centric::parameters::RollerCentric;
#[cfg(feature = "experimental")]
pub use experimental::roller_centric::run::{RollerRun, RollerSample};
#[cfg(feature = "experimental")]
pub use experimental::speed_law::SpeedLaw;
#[cfg(feature = "experimental")]
pub use experimental::speed_law_flow::SpeedLawFlow;
pub use head::default_pulse::DefaultPulse;
pub use head::flow_curve::{self, FlowCurve};
pub use head::geometry::Geometry;
pub use head::paper::{self, CONTACT_ANGLE_DEG as PUBLISHED_CONTACT_ANGLE_DEG};
pub use head::reaches::{Reach, Reaches};
pub use head::roller_volume::{self, RollerVolume};
#[cfg(feature = "construction")]
pub use hose::falling_drop::falling_drop_ml;
#[cfg(feature = "construction")]
pub use hose::fluid::Fluid;
#[cfg(feature = "construction")]
pub use hose::hose::Hose;
pub use line::exact_run::ExactRun;
pub use line::extremes::Extremes;
pub use line::friction::Friction;
pub use line::line::Line;
pub use line::line_state::LineState;
pub use line::propagator::LineStep;
pub use line::runs::exact_samples::ExactSamples;
pub use line::runs::exact_series::ExactSeries;
pub use line::runs::vessel_run::{BackFlow, VesselRun};
pub use line::settling::SETTLED_ML;
pub use math::{metrics, polynomial};
pub use motion::leg::Leg;
pub use motion::ripple::Ripple;
pub use motion::stretches::{Stretch, Stretches};
pub use port::Port;
pub use pump::presets::Variant;
pub use pump::pump::Pump;
pub use pump::steady_state::{SteadyState, SteadyStates};
#[cfg(feature = "sensitivity")]
pub use sensitivity::parameter::SensitivityParameter;
#[cfg(feature = "sensitivity")]
pub use sensitivity::run::SensitiveRun;
#[cfg(feature = "sensitivity")]
pub use sensitivity::samples::{SensitiveColumns, SensitiveSamples};
#[cfg(feature = "sensitivity")]
pub use sensitivity::state::SensitiveState;
