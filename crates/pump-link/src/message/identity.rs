//! The identity of a node.

use serde::{Deserialize, Serialize};

/// The identity of a node and its firmware.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Identity {
    /// Number of the board that no other board has.
    pub board: u64,
    /// Version of the firmware: major, minor, patch.
    pub firmware: [u16; 3],
    /// Number of axes.
    pub axes: u8,
    /// Number of segments that the queue of an axis holds.
    pub queue: u16,
    /// Rate of the node's timer, Hz.
    pub tick_hz: u32,
    /// Largest sum of the step rates of all axes, Hz.
    pub max_step_hz: u32,
}

impl Identity {
    /// Makes the identity of a board.
    pub const fn new(
        board: u64,
        firmware: [u16; 3],
        axes: u8,
        queue: u16,
        tick_hz: u32,
        max_step_hz: u32,
    ) -> Self {
        Self { board, firmware, axes, queue, tick_hz, max_step_hz }
    }
}
