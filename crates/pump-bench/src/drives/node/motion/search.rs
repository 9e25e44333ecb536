//! The search for a board that has fallen silent in motion.

use std::time::Duration;

/// Longest time for which a silent board is sought after the motion was to stop. A board that still runs tells its
/// count within it, if the line or a computer under load holds the answer back.
const STOP_LIMIT: Duration = Duration::from_millis(500);

/// Time between two questions to a silent board.
const KNOCK: Duration = Duration::from_millis(200);

/// Search for a board that has fallen silent.
#[derive(Debug)]
pub(super) struct Search {
    began: Duration,
    /// Longest time for which the board is sought.
    patience: Duration,
    /// Time of the last question.
    knocked_at: Option<Duration>,
    /// Time at which the motion was first to stop.
    stopped_at: Option<Duration>,
}

impl Search {
    /// Begins a search at a time of the wire.
    pub(super) fn new(now: Duration, patience: Duration) -> Self {
        Self { began: now, patience, knocked_at: None, stopped_at: None }
    }

    /// Returns true if the search is given up at `now`. `stops` tells that the motion is to end. A board that has told
    /// any axis something at `heard_at` still runs, so the answer for this one is on its way.
    pub(super) fn is_over(&self, now: Duration, heard_at: Duration, stops: bool) -> bool {
        let silent_since = |at: Duration| now.saturating_sub(at.max(heard_at));
        let stopped = self.stopped_at.is_some_and(|at| stops && silent_since(at) > STOP_LIMIT);
        stopped || silent_since(self.began) > self.patience
    }

    /// Returns true if the board is to be asked now. A wish to stop is told to it at once.
    pub(super) fn knocks(&mut self, now: Duration, stops: bool) -> bool {
        let is_new = stops && self.stopped_at.is_none();
        if is_new {
            self.stopped_at = Some(now);
        }
        let is_due = self.knocked_at.is_none_or(|at| now.saturating_sub(at) >= KNOCK);
        if is_new || is_due {
            self.knocked_at = Some(now);
        }
        is_new || is_due
    }
}
