//! The answers of the node.

use serde::{Deserialize, Serialize};

use super::AXES;
use super::axis_status::AxisStatus;
use super::faults::FaultCounts;
use super::identity::Identity;
use super::refusal::Refusal;

/// An answer of the node.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum Answer {
    /// The request was refused. Nothing has changed.
    Refused(Refusal),
    /// The node is this one.
    Identity(Identity),
    /// The node has the session of the request.
    Adopted,
    /// The axis is in this state.
    Status(AxisStatus),
    /// The axis has the revision of the request, and so many entries of its brake.
    Configured {
        /// Number of entries of the brake that are there.
        brake_entries: u8,
    },
    /// The move is prepared, or goes on.
    Accepted {
        /// Number of the segment that comes next.
        next: u32,
        /// Number of segments that fit now.
        room: u16,
    },
    /// The moves have a tick at which they begin.
    Begun,
    /// The moves end so.
    Stopped {
        /// End of the move of each axis. There is none of an axis that does not take part.
        ends: [Option<Stopping>; AXES],
    },
    /// Faults that no host has confirmed are so many.
    Faults {
        /// Number of faults of each kind.
        unread: FaultCounts,
    },
}

/// The end of a move, known when its stop begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Stopping {
    /// Tick at which the last step is due. It is the start of the move if no step is made.
    pub last_step_at: u64,
    /// Position after the last step, signed steps.
    pub final_count: i64,
}
