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
//! - `tmc`: the stepper driver TMC2209 behind one wire of the board.
#![allow(dead_code, unreachable_pub, unused_imports, reason = "the rooms wait for the drive that joins them")]

mod clock;
mod dictionary;
mod error;
mod fault;
mod link;
mod protocol;
mod refit;
mod tmc;

pub use clock::ClockError;
pub use dictionary::DictionaryError;
pub use error::KlipperError;
pub use protocol::MessageError;
pub use tmc::TmcError;
