//! Several axes of one board, each with a drive of its own: in turn, or together on one line of constant ratio.

mod lead;
mod meeting;
mod shared_board;

pub(super) use lead::{Ended, lead};
pub(super) use meeting::{Met, SILENCE, follow, meet};
pub(super) use shared_board::AxisBoard;
pub use shared_board::GrblBoard;
