//! The meeting of the motions that begin together. The last that is ready tells the board to begin all.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use super::{BeginPlace, CommonBeginError};

/// Begin that all motions of a meeting share.
#[derive(Debug)]
struct Begin {
    limit: Duration,
    state: Mutex<State>,
}

#[derive(Debug)]
struct State {
    /// Motions that are ready, each at its place.
    ready: Vec<Option<Ready>>,
    /// Place whose motion has told the board to begin all.
    sender: Option<usize>,
    has_begun: bool,
    /// True once the board was told to move, and has not refused.
    is_told: bool,
    failed: Option<CommonBeginError>,
}

/// Seat of one motion at the meeting.
#[derive(Debug)]
pub(super) struct Seat {
    number: usize,
    begin: Arc<Begin>,
    /// Time of the line's clock from which on the motion waits for the others.
    since: Option<Duration>,
}

/// Motion that is ready to begin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::drives) struct Ready {
    /// Line to the board, which tells boards apart.
    pub(in crate::drives) line: usize,
    pub(in crate::drives) axis: u8,
    /// Number of the axis's move.
    pub(in crate::drives) move_number: u32,
    /// Tick from which on the move can begin.
    pub(in crate::drives) at: u64,
}

/// State of a motion that is to begin with others.
#[derive(Debug, Clone, Copy, Default)]
pub(in crate::drives) struct Standing {
    /// Motion, once it is ready to begin.
    pub(in crate::drives) ready: Option<Ready>,
    /// True once the board has begun the motion.
    pub(in crate::drives) has_begun: bool,
    /// True once the board has refused to begin it.
    pub(in crate::drives) is_refused: bool,
    /// True once the motion is to end.
    pub(in crate::drives) stops: bool,
}

/// Next act of a motion that is to begin with others.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::drives) enum Next {
    /// The motion waits.
    Wait,
    /// The motion tells the board to begin all these at one tick.
    Send(Vec<Ready>),
    /// All have begun.
    Begun,
    /// None begins.
    Fail(CommonBeginError),
}

impl Seat {
    /// Returns the seats of so many motions.
    pub(super) fn all(count: usize, limit: Duration) -> Vec<Self> {
        let state =
            State { ready: vec![None; count], sender: None, has_begun: false, is_told: false, failed: None };
        let begin = Arc::new(Begin { limit, state: Mutex::new(state) });
        (0..count).map(|number| Self { number, begin: Arc::clone(&begin), since: None }).collect()
    }

    pub(super) fn view(&self) -> View {
        View(Arc::clone(&self.begin))
    }

    #[cfg(feature = "node")]
    fn is_sent(&self) -> bool {
        self.begin.state.lock().unwrap_or_else(PoisonError::into_inner).sender.is_some()
    }

    #[cfg(feature = "node")]
    fn gives_up(&mut self) -> bool {
        let mut state = self.begin.state.lock().unwrap_or_else(PoisonError::into_inner);
        let is_free = state.sender.is_none() && !state.has_begun;
        if is_free {
            state.failed.get_or_insert(CommonBeginError::Another);
        }
        is_free
    }

    /// Tells how this motion stands at `now`, by the clock of its line. Returns what it does next.
    fn look(&mut self, standing: Standing, now: Duration) -> Next {
        let mut state = self.begin.state.lock().unwrap_or_else(PoisonError::into_inner);
        state.has_begun |= standing.has_begun;
        if state.has_begun {
            return Next::Begun;
        }
        let waits = now.saturating_sub(*self.since.get_or_insert(now));
        let failed = match state.sender {
            _ if state.failed.is_some() => state.failed,
            // From here on the board decides. Its answer is on the way.
            Some(sender) if sender == self.number && standing.is_refused => {
                state.is_told = false;
                Some(CommonBeginError::Another)
            }
            Some(sender) if sender == self.number && !standing.stops => {
                if let Some(place) = state.ready.get_mut(self.number) {
                    *place = standing.ready.or(*place);
                }
                return Next::Send(state.ready.iter().copied().flatten().collect());
            }
            Some(_) => return Next::Wait,
            None if standing.stops => Some(CommonBeginError::Another),
            None if waits > self.begin.limit => {
                Some(CommonBeginError::Late { limit_s: self.begin.limit.as_secs_f64() })
            }
            None => None,
        };
        if let Some(error) = failed {
            state.failed = Some(error);
            return if standing.stops { Next::Wait } else { Next::Fail(error) };
        }
        if let Some(place) = state.ready.get_mut(self.number) {
            *place = standing.ready;
        }
        let all: Option<Vec<Ready>> = state.ready.iter().copied().collect();
        let Some(all) = all else { return Next::Wait };
        if !is_one_board(&all) {
            state.failed = Some(CommonBeginError::Boards);
            return Next::Fail(CommonBeginError::Boards);
        }
        state.sender = Some(self.number);
        Next::Send(all)
    }
}

/// View of a meeting.
#[derive(Debug)]
pub(super) struct View(Arc<Begin>);

impl View {
    /// Returns true if the board was told to begin all, and has not refused.
    pub(super) fn is_fixed(&self) -> bool {
        let state = self.0.state.lock().unwrap_or_else(PoisonError::into_inner);
        state.is_told
    }
}

impl BeginPlace {
    /// Tells how this motion stands at `now`, by the clock of its line. Returns what it does next.
    pub(in crate::drives) fn look(&mut self, standing: Standing, now: Duration) -> Next {
        self.seat.look(standing, now)
    }

    /// Returns true once a motion was to tell the board to begin all: they may move.
    #[cfg(feature = "node")]
    pub(in crate::drives) fn is_sent(&self) -> bool {
        self.seat.is_sent()
    }

    /// Gives the place up, so that none begins. Returns false if a motion was to tell the board to begin all before.
    #[cfg(feature = "node")]
    pub(in crate::drives) fn gives_up(&mut self) -> bool {
        self.seat.gives_up()
    }

    /// Notes that the board is told to move now: whatever becomes of this thread, the motions may begin.
    pub(in crate::drives) fn note_told(&mut self) {
        self.seat.begin.state.lock().unwrap_or_else(PoisonError::into_inner).is_told = true;
    }

    /// Notes that all have begun.
    #[cfg(feature = "grbl")]
    pub(in crate::drives) fn has_begun(&mut self) {
        let _ = self.look(Standing { has_begun: true, ..Standing::default() }, Duration::ZERO);
    }
}

/// Returns true if these are different axes of one board.
fn is_one_board(all: &[Ready]) -> bool {
    all.iter()
        .enumerate()
        .all(|(n, one)| all.iter().take(n).all(|other| other.line == one.line && other.axis != one.axis))
}

impl Drop for Seat {
    fn drop(&mut self) {
        let mut state = self.begin.state.lock().unwrap_or_else(PoisonError::into_inner);
        if !state.has_begun {
            state.failed.get_or_insert(CommonBeginError::Another);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::CommonBegin;
    use super::*;

    const NOW: Duration = Duration::from_secs(3);

    fn ready(axis: u8, at: u64) -> Standing {
        Standing { ready: Some(Ready { line: 1, axis, move_number: 1, at }), ..Standing::default() }
    }

    #[test]
    fn the_last_motion_that_is_ready_begins_all() {
        let mut places = CommonBegin::places(2, Duration::from_secs(60));
        assert_eq!(places[0].look(ready(0, 5), NOW), Next::Wait);
        assert!(matches!(places[1].look(ready(1, 7), NOW), Next::Send(all) if all.len() == 2));
        // Another stop waits for the board's answer.
        assert_eq!(places[0].look(Standing { stops: true, ..ready(0, 5) }, NOW), Next::Wait);
        assert_eq!(places[1].look(Standing { has_begun: true, ..ready(1, 7) }, NOW), Next::Begun);
        assert_eq!(places[0].look(ready(0, 5), NOW), Next::Begun);
    }

    #[test]
    fn a_place_that_is_given_up_or_stopped_keeps_all_from_beginning() {
        let mut places = CommonBegin::places(2, Duration::from_secs(60));
        drop(places.pop());
        assert_eq!(places[0].look(ready(0, 5), NOW), Next::Fail(CommonBeginError::Another));
        let mut places = CommonBegin::places(2, Duration::from_secs(60));
        assert_eq!(places[1].look(Standing { stops: true, ..Standing::default() }, NOW), Next::Wait);
        assert_eq!(places[0].look(ready(0, 5), NOW), Next::Fail(CommonBeginError::Another));
    }

    #[test]
    fn axes_of_two_boards_and_places_that_stay_empty_begin_nothing() {
        let mut places = CommonBegin::places(2, Duration::from_secs(60));
        assert_eq!(places[0].look(ready(0, 5), NOW), Next::Wait);
        assert_eq!(places[1].look(ready(0, 5), NOW), Next::Fail(CommonBeginError::Boards));
        assert_eq!(places[0].look(ready(0, 5), NOW), Next::Fail(CommonBeginError::Boards));
    }

    #[test]
    fn a_motion_waits_for_the_others_by_the_clock_of_its_line() {
        let mut places = CommonBegin::places(2, Duration::from_secs(10));
        for waits_s in 0..=10 {
            assert_eq!(places[0].look(ready(0, 5), NOW + Duration::from_secs(waits_s)), Next::Wait);
        }
        let late = places[0].look(ready(0, 5), NOW + Duration::from_millis(10_001));
        assert_eq!(late, Next::Fail(CommonBeginError::Late { limit_s: 10.0 }));
    }
}
