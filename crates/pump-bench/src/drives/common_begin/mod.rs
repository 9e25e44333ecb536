//! Motions that begin together, each run by a session and a thread of its own: those of several axes of one board at
//! one tick, and those of several Klipper boards at one instant.

#[cfg(not(any(feature = "grbl", feature = "node")))]
mod alone;
#[cfg(feature = "klipper")]
mod instant;
#[cfg(any(feature = "grbl", feature = "node"))]
mod meeting;

use std::time::Duration;

use thiserror::Error;

#[cfg(not(any(feature = "grbl", feature = "node")))]
use alone::Seat;
#[cfg(feature = "klipper")]
pub(super) use instant::Met;
#[cfg(any(feature = "grbl", feature = "node"))]
use meeting::Seat;
#[cfg(any(feature = "grbl", feature = "node"))]
pub(super) use meeting::{Next, Ready, Standing};

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

/// Begin that several axes of one board have in common, or several boards with the Klipper firmware.
///
/// [`Self::places`] makes a place for each. A thread gives its place to its session by
/// [`Session::begin_with`](crate::Session::begin_with) and runs its dose. All motions begin at one tick of the board.
/// Klipper boards begin at one instant, each by its own clock. If a motion fails or is stopped before, none begins.
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
    /// Seat at the meeting of boards that each turn one motor.
    #[cfg(feature = "klipper")]
    of_boards: instant::Seat,
}

impl CommonBegin {
    /// Makes places for `count` motions that begin together. A motion that is ready waits for the others for as long as
    /// `limit`.
    pub fn places(count: usize, limit: Duration) -> Vec<BeginPlace> {
        #[cfg(feature = "klipper")]
        let mut of_boards = instant::Seat::all(count, limit);
        let seats = Seat::all(count, limit).into_iter();
        #[cfg(feature = "klipper")]
        let places = seats.zip(of_boards.drain(..)).map(|(seat, of_boards)| BeginPlace { seat, of_boards });
        #[cfg(not(feature = "klipper"))]
        let places = seats.map(|seat| BeginPlace { seat });
        places.collect()
    }
}
