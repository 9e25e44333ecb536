//! The messages: requests of the host and answers of the node.
//!
//! Every request may come twice, late, or not at all. A request says which state it wants, under a number that
//! grows: revisions of an axis's configuration, moves, segments. A node that has the state answers so and does
//! nothing. These types belong to the link: a change to one of them is a new [`crate::frame::VERSION`].

mod answer;
mod axis_config;
mod axis_status;
mod faults;
mod identity;
mod refusal;
mod request;

pub use answer::{Answer, Stopping};
pub use axis_config::{AxisConfig, FaultOutput};
pub use axis_status::{AxisState, AxisStatus, End};
pub use faults::FaultCounts;
pub use identity::Identity;
pub use refusal::Refusal;
pub use request::{MoveChange, MoveOrder, Request};

/// Largest number of axes of a node.
pub const AXES: usize = 4;

/// Largest number of bytes of packed segments or entries in a request.
pub const MAX_PACKED: usize = 208;

/// Most bytes of packed segments in a request behind which a stop of four motors still acts within 1 ms of its frame,
/// as measured with an emulated RP2040 (docs/node.md). The node takes segments one by one, between the steps.
pub const PROMPT_PACKED: usize = 64;

/// Shortest dead-man time that a host may set, ms.
pub const SHORTEST_DEAD_MAN_MS: u16 = 100;

/// Longest dead-man time that a host may set, ms.
pub const LONGEST_DEAD_MAN_MS: u16 = 10_000;

/// Dead-man time of a node that was told no other, ms.
pub const DEAD_MAN_MS: u16 = 500;
