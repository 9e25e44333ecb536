//! The drive of a node: a board with this project's own firmware, which makes each step at the plan's time.
//!
//! The host plans and streams integer segments, and the board makes them (crate `pump-link`). The board is sent only
//! steps that have leave, less the way in which it stops by itself. So it comes to rest within the leave, whatever
//! happens to this process or to the link.

mod board;
mod connect;
mod error;
mod lead;
mod link;
mod motion;
mod move_feed;
mod node;
mod outcome;
mod session_record;
mod steps;
mod task;

pub use error::NodeError;
pub use node::Node;
pub(super) use node::open;
