//! Motions that begin together, each run by a session and a thread of its own: those of several axes of one board at
//! one tick, and those of several boards at one instant.

#[cfg(not(any(feature = "grbl", feature = "node")))]
mod alone;
#[cfg(any(feature = "node", feature = "klipper"))]
mod instant;
#[cfg(any(feature = "grbl", feature = "node"))]
mod meeting;

use std::time::Duration;

use thiserror::Error;

#[cfg(not(any(feature = "grbl", feature = "node")))]
use alone::{Seat, View};
#[cfg(any(feature = "node", feature = "klipper"))]
pub(crate) use instant::Met;
#[cfg(any(feature = "grbl", feature = "node"))]
pub(super) use meeting::{Next, Ready, Standing};
#[cfg(any(feature = "grbl", feature = "node"))]
use meeting::{Seat, View};

/// Time from the moment at which the motions of several boards are ready to the instant at which all begin. Each thread
/// looks within some milliseconds, and a Klipper board is loaded then.
pub(super) const BEGIN_LEAD: Duration = Duration::from_millis(200);

/// Reason for which a motion did not begin with the others. Its motor has not moved.
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
    /// The instant at which boards were to begin together has passed. The others may have begun.
    #[error(
        "the time at which this pump was to begin together with others has passed before the board had its steps, so \
         it has not begun, and the others may have; check what held this computer up"
    )]
    Missed,
    /// The clock of the motion's board was not read.
    #[error(
        "the clock of this pump's board was not read, so it begins nothing together with others; check its cable, and \
         run it again"
    )]
    Clock,
    /// The axes are not different axes of one board.
    #[error(
        "these places are for different axes of one board, and one of them was given to a motion of another board; \
         make places for several boards with `CommonBegin::places_of_boards`"
    )]
    Boards,
}

/// Begin that several axes of one board have in common, or several boards.
///
/// [`Self::places`] makes a place for each axis of one board: all begin at one tick of its clock.
/// [`Self::places_of_boards`] makes those of motions at several boards, nodes and Klipper boards: all begin at one
/// instant, each by the clock of its own board. A thread gives its place to its session by
/// [`Session::begin_with`](crate::Session::begin_with) and runs its dose. If a motion fails or is stopped while they
/// wait for each other, none begins. Several boards, and the motors of a Klipper board, are told their instant 0.2 s
/// ahead. From then on the others begin, and a motion that fails or is stopped leaves its dose unfinished.
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
pub struct CommonBegin(());

/// Place of one motion in a common begin. A place that is dropped before the begin keeps the others from beginning.
#[derive(Debug)]
pub struct BeginPlace {
    /// Seat at the meeting of axes of one board.
    #[cfg_attr(not(any(feature = "grbl", feature = "node")), allow(dead_code, reason = "no board has axes"))]
    seat: Seat,
    /// Seat at the meeting of motions that begin at one instant.
    #[cfg(any(feature = "node", feature = "klipper"))]
    at_instant: instant::Seat,
    /// True if the motions are of several boards.
    is_of_boards: bool,
}

/// View of a common begin.
#[derive(Debug)]
pub(crate) struct BeginView {
    seat: View,
    #[cfg(any(feature = "node", feature = "klipper"))]
    at_instant: instant::View,
}

impl BeginView {
    /// Returns true if the motions begin, or may have begun: nothing calls their begin off any more.
    pub(crate) fn is_fixed(&self) -> bool {
        #[cfg(any(feature = "node", feature = "klipper"))]
        if self.at_instant.is_fixed() {
            return true;
        }
        self.seat.is_fixed()
    }
}

impl CommonBegin {
    /// Makes places for `count` motions of one board that begin together. A motion that is ready waits for the others
    /// for as long as `limit`.
    pub fn places(count: usize, limit: Duration) -> Vec<BeginPlace> {
        Self::all(count, limit, false)
    }

    /// Makes places for `count` motions of several boards that begin together, as [`Self::places`] does. A grbl board
    /// begins nothing with other boards.
    pub fn places_of_boards(count: usize, limit: Duration) -> Vec<BeginPlace> {
        Self::all(count, limit, true)
    }

    fn all(count: usize, limit: Duration, is_of_boards: bool) -> Vec<BeginPlace> {
        let seats = Seat::all(count, limit).into_iter();
        #[cfg(any(feature = "node", feature = "klipper"))]
        let places = seats.zip(instant::Seat::all(count, limit)).map(|(seat, at_instant)| BeginPlace {
            seat,
            at_instant,
            is_of_boards,
        });
        #[cfg(not(any(feature = "node", feature = "klipper")))]
        let places = seats.map(|seat| BeginPlace { seat, is_of_boards });
        places.collect()
    }
}

impl BeginPlace {
    /// Returns true if motions at other boards begin with this one.
    pub fn is_of_boards(&self) -> bool {
        self.is_of_boards
    }

    /// Returns a view of the begin, which holds no place in it.
    pub(crate) fn view(&self) -> BeginView {
        BeginView {
            seat: self.seat.view(),
            #[cfg(any(feature = "node", feature = "klipper"))]
            at_instant: self.at_instant.view(),
        }
    }

    /// Returns the time from the moment at which all motions are ready to their begin, in s.
    pub(crate) fn lead_s(&self) -> f64 {
        if self.is_of_boards { BEGIN_LEAD.as_secs_f64() } else { 0.0 }
    }
}
