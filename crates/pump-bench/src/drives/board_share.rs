//! The part of its board that a motion takes.

/// Part of a board, and of the line to it, that a motion of one axis takes. The axes of a board share both.
///
/// ```
/// use pump_bench::drives::BoardShare;
///
/// let share = BoardShare { steps_s: 40_000, all_steps_s: 62_500, bytes_s: 3_000, all_bytes_s: 36_864 };
/// assert!(2 * share.steps_s > share.all_steps_s, "two such motions do not run at once");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BoardShare {
    /// Steps a second that the board counts for the motion.
    pub steps_s: u32,
    /// Steps a second that the board makes with all its axes.
    pub all_steps_s: u32,
    /// Bytes a second that the motion takes of the line.
    pub bytes_s: u32,
    /// Bytes a second that the line carries for all axes.
    pub all_bytes_s: u32,
}
