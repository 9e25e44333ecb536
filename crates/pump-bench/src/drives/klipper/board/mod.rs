//! The board of a motor: how it is met, configured and asked.

mod board;
mod board_motor;
mod board_record;
mod commands;
mod configuration;
mod connect;
mod driver_line;
mod objects;
mod reset;
mod session_record;
mod shared_board;
mod step_rate;
mod terms;
mod told;

pub(super) use board::{Board, Talk, reason};
#[cfg(all(feature = "grbl", feature = "node"))]
pub(super) use commands::Commands;
pub(super) use connect::{Met, marks, meet};
pub(super) use driver_line::{ask as ask_driver, check as check_driver};
pub(super) use reset::be_still;
pub(super) use session_record::SessionRecord;
pub(super) use shared_board::SharedBoard;
pub(super) use terms::Terms;
pub(in crate::drives) use told::told_by_record;
