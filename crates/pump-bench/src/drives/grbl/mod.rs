//! The drive for controllers that speak grbl 1.1's protocol over a serial port: grbl, grblHAL, FluidNC.

mod axis;
mod board;
mod code;
mod configure;
mod connect;
mod error;
mod holder;
mod jogs;
mod port;
mod recovery;
#[doc(hidden)]
pub mod reply;
mod scale;
mod search;
mod settings;

pub(super) use axis::ABILITIES;
pub use axis::Grbl;
pub use error::GrblError;
