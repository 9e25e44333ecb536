//! The drive of a node: a board with this project's own firmware, which makes each step at the plan's time.
//!
//! The host plans and streams integer segments, and the board makes them (crate `pump-link`). The board is sent only
//! steps that have leave, less the way in which it stops by itself. So it comes to rest within the leave, whatever
//! happens to this process or to the link.
//!
//! A thread of its own streams, while the thread of the session asks for leave. So the motor runs on while that one is
//! held up, as far as there is leave.

#[cfg(feature = "grbl")]
mod ask;
mod axes;
mod board;
mod board_record;
mod connect;
mod error;
mod line;
mod link;
mod motion;
mod node;
mod node_board;
mod session_record;
mod shared_line;
mod unread_faults;

#[cfg(feature = "grbl")]
pub(super) use ask::ask;
pub use axes::{AxisRun, NodeAxes, NodeAxis};
pub use error::NodeError;
pub use node::Node;
pub(super) use node::open;
pub use node_board::NodeBoard;
