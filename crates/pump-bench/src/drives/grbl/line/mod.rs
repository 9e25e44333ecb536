//! Several axes of one board, each with a drive of its own: in turn, or together on one line of constant ratio.

mod lead;
mod line;
mod meeting;
mod shared_board;

pub(super) use lead::lead;
pub(super) use line::AxisEnd;
pub(super) use meeting::{Met, SILENCE, follow, meet};
pub(super) use shared_board::AxisBoard;
pub use shared_board::GrblBoard;
