//! Requests that a node refuses.

use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::{LONGEST_DEAD_MAN_MS, SHORTEST_DEAD_MAN_MS};

/// The refusal of a request. Nothing has changed at the node.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, Error)]
#[non_exhaustive]
pub enum Refusal {
    /// The request is of another version of the protocol.
    #[error("the board has version {known} of the protocol; update the older of program and board")]
    Version {
        /// Version that the node knows.
        known: u8,
    },
    /// The checksum fits, and the request is none of this version.
    #[error("the board does not know the request")]
    Malformed,
    /// The node holds another session, or none after a reset. The answer's header has its number.
    #[error("the board holds another session; it was reset, or another program has taken it")]
    Session,
    /// The node has no such axis.
    #[error("the board has {axes} axes, counted from 0")]
    Axis {
        /// Number of axes.
        axes: u8,
    },
    /// The dead-man time is out of range.
    #[error("the dead-man time is out of range; allowed: {SHORTEST_DEAD_MAN_MS} to {LONGEST_DEAD_MAN_MS} ms")]
    DeadMan,
    /// A value of the configuration is out of range.
    #[error(
        "the configuration is out of range; allowed: step and direction times up to 100 us, 1 s from enable to the \
         first step, 1 to 32 entries of the brake"
    )]
    Config,
    /// The entries make no brake, or are not those that come next.
    #[error("the entries make no brake; {entries} of them are there")]
    Brake {
        /// Number of entries that are there.
        entries: u8,
    },
    /// The axis is not configured in this session.
    #[error("the axis is not configured in this session")]
    NotConfigured,
    /// The motor moves.
    #[error("the motor moves; wait for its end or stop it")]
    Moving,
    /// The number of the revision or the move is older than the newest that the node knows.
    #[error("the request is older than {newest}, the newest that the board knows")]
    Old {
        /// Newest revision or move.
        newest: u32,
    },
    /// The axis has no move of this number, or the move has ended.
    #[error("the move {newest} of the axis is its last, and takes no more")]
    NoSuchMove {
        /// Newest move of the axis.
        newest: u32,
    },
    /// Segments before these are missing.
    #[error("segment {next} comes next; those before it are missing")]
    Gap {
        /// Number of the segment that comes next.
        next: u32,
    },
    /// A segment cannot be made, turns round, is faster than announced, or leads beyond the end of its move.
    #[error(
        "segment {number} cannot be made, turns round, is faster than the move has announced, or leads beyond its end"
    )]
    Segment {
        /// Number of the segment in its move.
        number: u32,
    },
    /// The move begins elsewhere than at the motor's position.
    #[error("the move does not begin at position {position}, where the motor is")]
    Position {
        /// Position of the motor, signed steps.
        position: i64,
    },
    /// The axes would make more steps a second than the node can.
    #[error("the axes would make {sum_hz} steps a second together; allowed: {allowed_hz}")]
    StepRate {
        /// Sum of the step rates with that of the move, Hz.
        sum_hz: u32,
        /// Largest sum of step rates, Hz.
        allowed_hz: u32,
    },
    /// Intervals of the move are shorter than a pulse of the driver.
    #[error("the move's shortest interval is shorter than a step pulse and its pause; dose more slowly")]
    Pulse,
    /// The move has no steps, or none of its segments has come.
    #[error("the move has no steps, or none of its segments has come")]
    Empty,
    /// The tick has passed, or comes before the motor is energised, or is more than 10 s away.
    #[error("the move cannot begin at this tick; allowed: tick {earliest} to 10 s later")]
    Begin {
        /// Earliest tick at which the move can begin.
        earliest: u64,
    },
    /// The emergency stop is pressed.
    #[error("the emergency stop is pressed; release it, and configure the axis anew")]
    Estop,
    /// The stepper driver reports a fault.
    #[error("the stepper driver reports a fault; check its temperature, its supply and the motor's cable")]
    Driver,
    /// The angle was lost since the axis was configured.
    #[error("the rotor may have turned since the axis was configured; configure it anew and find its angle")]
    AngleLost,
    /// The change of a move leads back, or replaces segments that the node holds.
    #[error(
        "the move cannot be changed there: its segments up to {next} are taken, and lead to position {position}"
    )]
    Change {
        /// Number of the segment that comes next.
        next: u32,
        /// Position after the segments taken, signed steps.
        position: i64,
    },
}
