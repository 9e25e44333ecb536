//! The drives that turn a motor.

mod abilities;
mod borrowed;
mod drive;
#[cfg(feature = "grbl")]
mod grbl;
pub(crate) mod grbl_speeds;
mod identity;
mod opening;
pub(crate) mod registry;
mod sim;
mod stepped;
mod stop_request;
#[cfg(not(feature = "grbl"))]
mod without_grbl;

pub use abilities::Abilities;
pub use drive::{Disturbance, Drive, DriveError, DriveFault, DriveLimits, Gate, IndexSearch, Leave, Watch};
#[doc(hidden)]
#[cfg(feature = "grbl")]
pub use grbl::reply as grbl_reply;
#[doc(hidden)]
#[cfg(feature = "grbl")]
pub use grbl::wire as grbl_wire;
#[cfg(feature = "grbl")]
pub use grbl::{Grbl, GrblError, ask_ports, serial_ports};
pub(crate) use identity::Identity;
pub use opening::Opening;
pub use sim::Sim;
pub use stepped::{MonotonicClock, Stepped, SteppedError};
pub use stop_request::StopRequest;
