//! The node's half of the link: which segments are new, and when the host was last heard.

mod dead_man;
mod expected;

pub use dead_man::DeadMan;
pub use expected::{Arrival, Expected};
