//! The requests of the host.

use serde::{Deserialize, Serialize};

use super::AXES;
use super::axis_config::AxisConfig;
use super::faults::FaultCounts;

/// A request of the host. Every request has one answer.
///
/// Axes count from 0. Revisions and moves count from 1, and grow within a session.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum Request<'a> {
    /// Asks who the node is. Needs no session, and does not feed the dead-man timer without one.
    Identify,
    /// Gives the node the session number of the frame's header. Refused while anything moves under another one.
    Adopt {
        /// Time without a valid frame after which the node decelerates, ms.
        dead_man_ms: u16,
    },
    /// Asks for the state of an axis.
    Status {
        /// Axis.
        axis: u8,
    },
    /// Configures an axis that stands. The entries of its brake follow.
    Configure {
        /// Axis.
        axis: u8,
        /// Revision of the configuration.
        revision: u32,
        /// Configuration.
        config: AxisConfig,
    },
    /// Entries of the brake of an axis. The pins become outputs when the last entry is there.
    Brake {
        /// Axis.
        axis: u8,
        /// Revision of the configuration that the brake belongs to.
        revision: u32,
        /// Number of the first of these entries, from 0.
        first: u8,
        /// Entries, packed with [`crate::packing::Grain::Exact`].
        #[serde(borrow)]
        entries: &'a [u8],
    },
    /// Prepares a move of an axis that stands, and energises its motor.
    Prepare {
        /// Axis.
        axis: u8,
        /// Number of the move.
        move_number: u32,
        /// Bounds of the move.
        order: MoveOrder,
    },
    /// Segments of a move.
    Segments {
        /// Axis.
        axis: u8,
        /// Number of the move.
        move_number: u32,
        /// Number of the first of these segments in the move, from 0.
        first: u32,
        /// Segments, packed with [`crate::packing::Grain::Fine`].
        packed: &'a [u8],
    },
    /// Begins the moves that are named, all at one tick.
    Begin {
        /// Tick of the node's timer from which the moves count.
        at: u64,
        /// Number of the move of each axis. It is 0 for an axis that does not take part.
        moves: [u32; AXES],
    },
    /// Decelerates the moves that are named. A move that has not begun never begins.
    Stop {
        /// Number of the move of each axis. It is 0 for an axis that does not take part.
        moves: [u32; AXES],
    },
    /// Confirms faults that were read. The node forgets as many of each kind.
    FaultsRead {
        /// Axis.
        axis: u8,
        /// Number of faults of each kind since power-up that the host has read.
        read: FaultCounts,
    },
    /// Gives a move another end, and another plan from a segment on. The segments before it stay as they are.
    Retarget {
        /// Axis.
        axis: u8,
        /// Number of the move.
        move_number: u32,
        /// Bounds of the rest.
        change: MoveChange,
    },
}

/// The change of a move under way: another plan takes over just after a segment.
///
/// No segment of the old plan from `first` on was ever sent, so a number means one segment, however often and in
/// whatever order frames arrive. Segments of the new plan are sent once the change was accepted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct MoveChange {
    /// Number of the change in its move, from 1. A repeated one is ignored.
    pub number: u32,
    /// Number of the first segment of the new plan.
    pub first: u32,
    /// Position after the last step of the new plan, signed steps. Nothing makes the motor go beyond it.
    pub last: i64,
    /// Shortest interval between two steps of the new plan, whole ticks. The shorter of the old and the new plan's
    /// reserves the axis's share of the steps that the node can make.
    pub shortest_interval: u32,
}

/// The bounds of a move, known before its first segment.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct MoveOrder {
    /// Position before the move, signed steps. The node refuses a move from elsewhere.
    pub from: i64,
    /// Position after the move's last step, signed steps. Nothing makes the motor go beyond it.
    pub last: i64,
    /// Shortest interval between two steps of the move, whole ticks, in the segments as they are sent. It reserves
    /// the axis's share of the steps that the node can make.
    pub shortest_interval: u32,
}
