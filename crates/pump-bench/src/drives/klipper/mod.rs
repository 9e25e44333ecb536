//! The drive of a board with the Klipper firmware, which makes steps in whole ticks of its own clock.
//!
//! The firmware is another project's, and stays as it is. This room speaks its documented protocol: `docs/Protocol.md`
//! and `docs/MCU_Commands.md` of the repository Klipper3d/klipper.
//!
//! - `protocol`: numbers, messages and blocks as bytes.
//! - `dictionary`: the messages and constants that a board tells of itself.
//! - `link`: blocks over a wire, each taken once and in order.
//! - `clock`: the board's clock by the computer's.
//! - `refit`: the steps of a plan as commands of whole ticks.
//! - `board`: meeting a board, its configuration and its session.
//! - `motion`: commands of steps out, steps made in.
//! - `axis`: the drive of one motor.
//! - `tmc`: the stepper driver TMC2209 behind one wire of the board.

#[cfg(all(feature = "grbl", feature = "node"))]
mod ask;
mod axis;
mod board;
#[cfg(all(feature = "grbl", feature = "node"))]
mod board_pins;
mod dictionary;
mod error;
mod fault;
mod link;
mod motion;
mod protocol;
mod refit;
mod tmc;

#[cfg(all(feature = "grbl", feature = "node"))]
pub(super) use ask::ask;
pub use axis::Klipper;
pub(super) use axis::open;
pub(super) use board::told_by_record;
#[cfg(all(feature = "grbl", feature = "node"))]
pub use board_pins::BoardPins;
pub use dictionary::DictionaryError;
pub use error::KlipperError;
pub use protocol::MessageError;
pub use refit::RefitError;
pub use tmc::TmcError;
