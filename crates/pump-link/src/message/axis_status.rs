//! The state of an axis.

use serde::{Deserialize, Serialize};

use super::faults::FaultCounts;

/// The state of an axis, and where its motor is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct AxisStatus {
    /// Steps made since power-up, signed.
    pub position: i64,
    /// State of the axis.
    pub state: AxisState,
    /// Revision of the axis's configuration. It is 0 before the first of the session.
    pub revision: u32,
    /// Number of the last move. It is 0 before the first of the session.
    pub move_number: u32,
    /// Number of the segment of that move that comes next.
    pub next_segment: u32,
    /// Number of segments that fit now.
    pub room: u16,
    /// True if the motor is energised.
    pub energised: bool,
    /// True if the rotor may have turned by other means than counted steps since the axis was configured.
    pub angle_lost: bool,
    /// Position at which the index sensor last became active in the last move, signed steps.
    pub index_at: Option<i64>,
    /// Number of faults since power-up.
    pub faults: FaultCounts,
    /// Number of those faults that no host has confirmed.
    pub unread: FaultCounts,
}

/// The state of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum AxisState {
    /// The axis is not configured in this session.
    Unconfigured,
    /// The motor stands, and no move was prepared.
    Ready,
    /// The last move takes segments, and has not begun.
    Prepared,
    /// The last move has a tick at which it begins, or is under way.
    Moving,
    /// The last move decelerates, and ends so.
    Ending(End),
    /// The motor stands after the last move, which ended so.
    Ended(End),
}

/// The way in which a move ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum End {
    /// The move is complete.
    Complete,
    /// The host stopped the move.
    Stopped,
    /// No valid frame came within the dead-man time.
    DeadMan,
    /// The queue of segments ran dry.
    Starved,
    /// A step came when the next one was due already.
    Late,
    /// The stepper driver reported a fault.
    Driver,
    /// The emergency stop was pressed.
    Estop,
}
