//! Motions of several axes of one board that begin at one tick, each run by a session and a thread of its own.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use thiserror::Error;

/// Reason for which axes that were to begin together did not begin. Nothing has moved.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[non_exhaustive]
pub enum CommonBeginError {
    /// Another axis was stopped, refused or given up before the begin.
    #[error("an axis that was to begin together with this one was stopped or failed before, so none began")]
    Another,
    /// Not all axes were ready in time.
    #[error(
        "not all axes that were to begin together were ready within {limit_s:.1} s, so none began; run a motion for \
         each place, or allow more time"
    )]
    Late {
        /// Time that was allowed, in s.
        limit_s: f64,
    },
    /// The axes are not different axes of one board.
    #[error("axes that begin together are different axes of one board; begin the others one after another")]
    Boards,
}

/// Begin that several axes of one board have in common.
///
/// [`Self::places`] makes a place for each. A thread gives its place to its session by
/// [`Session::begin_with`](crate::Session::begin_with) and runs its dose. All motions begin at one tick of the board.
/// If one fails or is stopped before, none begins.
///
/// ```
/// use std::time::Duration;
///
/// use pump_bench::drives::CommonBegin;
///
/// let places = CommonBegin::places(4, Duration::from_secs(10));
/// assert_eq!(places.len(), 4);
/// ```
#[derive(Debug)]
pub struct CommonBegin {
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
    failed: Option<CommonBeginError>,
}

/// Place of one motion in a common begin. A place that is dropped before the begin keeps the others from beginning.
#[derive(Debug)]
pub struct BeginPlace {
    number: usize,
    begin: Arc<CommonBegin>,
    /// Time of the line's clock from which on the motion waits for the others.
    since: Option<Duration>,
}

/// Motion that is ready to begin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(not(feature = "node"), allow(dead_code, reason = "grbl needs less of it than a node"))]
pub(super) struct Ready {
    /// Line to the board, which tells boards apart.
    pub(super) line: usize,
    pub(super) axis: u8,
    /// Number of the axis's move.
    pub(super) move_number: u32,
    /// Tick from which on the move can begin.
    pub(super) at: u64,
}

/// State of a motion that is to begin with others.
#[derive(Debug, Clone, Copy, Default)]
#[cfg_attr(not(feature = "node"), allow(dead_code, reason = "grbl needs less of it than a node"))]
pub(super) struct Standing {
    /// Motion, once it is ready to begin.
    pub(super) ready: Option<Ready>,
    /// True once the board has begun the motion.
    pub(super) has_begun: bool,
    /// True once the board has refused to begin it.
    pub(super) is_refused: bool,
    /// True once the motion is to end.
    pub(super) stops: bool,
}

/// Next act of a motion that is to begin with others.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(not(feature = "node"), allow(dead_code, reason = "grbl needs less of it than a node"))]
pub(super) enum Next {
    /// The motion waits.
    Wait,
    /// The motion tells the board to begin all these at one tick.
    Send(Vec<Ready>),
    /// All have begun.
    Begun,
    /// None begins.
    Fail(CommonBeginError),
}

impl CommonBegin {
    /// Makes places for `count` motions that begin together. A motion that is ready waits for the others for as long as
    /// `limit`.
    pub fn places(count: usize, limit: Duration) -> Vec<BeginPlace> {
        let state = State { ready: vec![None; count], sender: None, has_begun: false, failed: None };
        let begin = Arc::new(Self { limit, state: Mutex::new(state) });
        (0..count).map(|number| BeginPlace { number, begin: Arc::clone(&begin), since: None }).collect()
    }
}

#[cfg_attr(not(feature = "node"), allow(dead_code, reason = "grbl needs less of it than a node"))]
impl BeginPlace {
    /// Tells how this motion stands at `now`, by the clock of its line. Returns what it does next.
    pub(super) fn look(&mut self, standing: Standing, now: Duration) -> Next {
        let mut state = self.begin.state.lock().unwrap_or_else(PoisonError::into_inner);
        state.has_begun |= standing.has_begun;
        if state.has_begun {
            return Next::Begun;
        }
        let waits = now.saturating_sub(*self.since.get_or_insert(now));
        let failed = match state.sender {
            _ if state.failed.is_some() => state.failed,
            // From here on the board decides. Its answer is on the way.
            Some(sender) if sender == self.number && standing.is_refused => Some(CommonBeginError::Another),
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

    /// Notes that all have begun.
    #[cfg(feature = "grbl")]
    pub(super) fn has_begun(&mut self) {
        let _ = self.look(Standing { has_begun: true, ..Standing::default() }, Duration::ZERO);
    }
}

/// Returns true if these are different axes of one board.
fn is_one_board(all: &[Ready]) -> bool {
    all.iter()
        .enumerate()
        .all(|(n, one)| all.iter().take(n).all(|other| other.line == one.line && other.axis != one.axis))
}

impl Drop for BeginPlace {
    fn drop(&mut self) {
        let mut state = self.begin.state.lock().unwrap_or_else(PoisonError::into_inner);
        if !state.has_begun {
            state.failed.get_or_insert(CommonBeginError::Another);
        }
    }
}

#[cfg(all(test, feature = "node"))]
mod tests {
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
