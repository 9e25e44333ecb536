//! The drive for controllers that speak grbl 1.1's protocol over a serial port: grbl, grblHAL, FluidNC.

mod ask;
mod axis;
mod axis_name;
mod board;
mod code;
mod connect;
mod error;
mod jogs;
mod line;
mod recovery;
mod remarks;
pub mod reply;
mod rests;
mod scale;
mod search;
mod settings;

pub use ask::ask_ports;
#[cfg(feature = "node")]
pub(super) use ask::{ask, ask_board};
pub use axis::Grbl;
pub(super) use axis::open;
pub use error::GrblError;
pub use line::GrblBoard;
pub(super) use settings::recorded_limits;
