//! A build without boards, whose motions meet no others.

use std::time::Duration;

/// Seat of one motion.
#[derive(Debug)]
pub(super) struct Seat;

impl Seat {
    /// Returns the seats of so many motions.
    pub(super) fn all(count: usize, _limit: Duration) -> Vec<Self> {
        (0..count).map(|_| Self).collect()
    }

    pub(super) fn view(&self) -> View {
        View
    }
}

/// View of a meeting.
#[derive(Debug)]
pub(super) struct View;

impl View {
    #[allow(clippy::unused_self, reason = "the view of a board's axes has a state")]
    pub(super) fn is_fixed(&self) -> bool {
        false
    }
}
