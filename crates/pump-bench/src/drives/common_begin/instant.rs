//! The meeting of motions at several boards, which begin at one instant. The last that is ready chooses it.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use super::{BeginPlace, CommonBeginError};

/// Begin that all motions of a meeting share.
#[derive(Debug)]
struct Begin {
    limit: Duration,
    state: Mutex<State>,
}

#[derive(Debug)]
struct State {
    /// True at the place of each motion that is ready.
    ready: Vec<bool>,
    /// Instant at which all begin, once all were ready.
    at: Option<Instant>,
    failed: Option<CommonBeginError>,
}

/// Seat of one motion at the meeting.
#[derive(Debug)]
pub(super) struct Seat {
    number: usize,
    begin: Arc<Begin>,
    /// Instant from which on the motion waits for the others.
    since: Option<Instant>,
}

/// State of a meeting.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Met {
    /// Another motion is not ready yet.
    Waits,
    /// All begin at this instant.
    At(Instant),
    /// None begins.
    Failed(CommonBeginError),
}

impl Seat {
    /// Returns the seats of so many motions.
    pub(super) fn all(count: usize, limit: Duration) -> Vec<Self> {
        let state = State { ready: vec![false; count], at: None, failed: None };
        let begin = Arc::new(Begin { limit, state: Mutex::new(state) });
        (0..count).map(|number| Self { number, begin: Arc::clone(&begin), since: None }).collect()
    }

    pub(super) fn view(&self) -> View {
        View(Arc::clone(&self.begin))
    }

    fn meet(&mut self, now: Instant, ahead: Duration) -> Met {
        let mut state = self.begin.state.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(at) = state.at {
            return Met::At(at);
        }
        let waits = now.saturating_duration_since(*self.since.get_or_insert(now));
        if waits > self.begin.limit {
            let limit_s = self.begin.limit.as_secs_f64();
            state.failed.get_or_insert(CommonBeginError::Late { limit_s });
        }
        if let Some(error) = state.failed {
            return Met::Failed(error);
        }
        if let Some(ready) = state.ready.get_mut(self.number) {
            *ready = true;
        }
        if !state.ready.iter().all(|ready| *ready) {
            return Met::Waits;
        }
        let at = now + ahead;
        state.at = Some(at);
        Met::At(at)
    }
}

/// View of a meeting.
#[derive(Debug)]
pub(super) struct View(Arc<Begin>);

impl View {
    /// Returns true if the instant was chosen.
    pub(super) fn is_fixed(&self) -> bool {
        self.0.state.lock().unwrap_or_else(PoisonError::into_inner).at.is_some()
    }
}

impl BeginPlace {
    /// Tells that this motion is ready at `now`. The last of all has them begin `ahead` of its time.
    pub(crate) fn meet(&mut self, now: Instant, ahead: Duration) -> Met {
        self.at_instant.meet(now, ahead)
    }
}

impl Drop for Seat {
    fn drop(&mut self) {
        let mut state = self.begin.state.lock().unwrap_or_else(PoisonError::into_inner);
        if state.at.is_none() {
            state.failed.get_or_insert(CommonBeginError::Another);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::CommonBegin;
    use super::*;

    const AHEAD: Duration = Duration::from_millis(200);
    const LIMIT: Duration = Duration::from_secs(10);

    #[test]
    fn the_last_motion_that_is_ready_chooses_the_instant_of_all() {
        let (mut places, now) = (CommonBegin::places(3, LIMIT), Instant::now());
        let later = now + Duration::from_secs(4);
        assert_eq!(places[0].meet(now, AHEAD), Met::Waits);
        assert_eq!(places[0].meet(later, AHEAD), Met::Waits);
        assert_eq!(places[2].meet(now, AHEAD), Met::Waits);
        assert_eq!(places[1].meet(later, AHEAD), Met::At(later + AHEAD));
        drop(places.pop());
        assert_eq!(places[0].meet(later + AHEAD, AHEAD), Met::At(later + AHEAD));
    }

    #[test]
    fn a_place_that_is_given_up_or_waits_too_long_keeps_all_from_beginning() {
        let (mut places, now) = (CommonBegin::places(2, LIMIT), Instant::now());
        drop(places.pop());
        assert_eq!(places[0].meet(now, AHEAD), Met::Failed(CommonBeginError::Another));
        let mut places = CommonBegin::places(2, LIMIT);
        assert_eq!(places[0].meet(now, AHEAD), Met::Waits);
        let late = Met::Failed(CommonBeginError::Late { limit_s: 10.0 });
        assert_eq!(places[0].meet(now + LIMIT + AHEAD, AHEAD), late);
        assert_eq!(places[1].meet(now, AHEAD), late);
    }
}
