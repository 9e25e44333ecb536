//! The meeting of the axes that move as one line. The last that is ready leads, and asks the others for their leave.

use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, PoisonError};
use std::thread::sleep;
use std::time::{Duration, Instant};

use super::lead::Ended;
use super::shared_board::AxisBoard;
use crate::drives::common_begin::{Next, Ready, Standing};
use crate::drives::grbl::error::GrblError;
use crate::drives::grbl::jogs::Follower;
use crate::drives::grbl::recovery::Made;
use crate::drives::{BeginPlace, Gate, Leave};

/// Time between two looks at the other axes.
const LOOK: Duration = Duration::from_millis(1);

/// Word of the axis that leads to one that follows.
#[derive(Debug)]
pub(super) enum Word {
    /// The first number of steps are made, and those up to the second are about to be.
    MayGo(u64, u64),
    /// The line has ended.
    Ended(Ended),
}

/// Share of one axis in a line, with the way to the thread that asks its gate.
#[derive(Debug)]
pub(in crate::drives::grbl) struct Share {
    pub(super) axis: Follower,
    pub(super) words: Sender<Word>,
    pub(super) leaves: Receiver<Leave>,
}

/// Way of a thread to the one that leads.
#[derive(Debug)]
pub(in crate::drives::grbl) struct Led {
    words: Receiver<Word>,
    leaves: Sender<Leave>,
}

/// End of a meeting.
#[derive(Debug)]
pub(in crate::drives::grbl) enum Met {
    /// This axis leads these others.
    Leads(Vec<Share>),
    /// Another axis leads this one.
    Follows(Led),
    /// The gate said stop, so that none begins.
    Stopped,
}

/// Waits until all axes are ready, for as long as their places allow.
///
/// # Errors
///
/// [`GrblError::Common`] if not all are ready in time, or another was stopped or refused.
pub(in crate::drives::grbl) fn meet(
    board: &AxisBoard,
    place: &mut BeginPlace,
    axis: Follower,
    gate: &mut Gate<'_>,
) -> Result<Met, GrblError> {
    let ((words, heard), (leaves, left)) = (channel(), channel());
    let shares = || board.shared.shares.lock().unwrap_or_else(PoisonError::into_inner);
    shares().push(Share { axis, words, leaves: left });
    let number = board.axis.number() as u8;
    let line = Arc::as_ptr(&board.shared) as usize;
    let ready = Some(Ready { line, axis: number, move_number: 0, at: 0 });
    // The threads sleep between two looks, by the computer's clock.
    let (began, mut has_stopped) = (Instant::now(), false);
    let met: Result<bool, GrblError> = loop {
        let stops = !has_stopped && gate(0, 0) == Leave::Stop;
        has_stopped |= stops;
        match place.look(Standing { ready, stops, ..Standing::default() }, began.elapsed()) {
            Next::Wait => sleep(LOOK),
            Next::Begun => return Ok(Met::Follows(Led { words: heard, leaves })),
            Next::Send(_) => break Ok(true),
            Next::Fail(_) if has_stopped => break Ok(false),
            Next::Fail(error) => break Err(error.into()),
        }
    };
    // Those of this meeting alone wait: a board makes one line at a time.
    let mut shares = shares();
    let is_own = |share: &Share| share.axis.scale.axis == board.axis;
    if let Some(own) = shares.iter().position(is_own) {
        shares.swap_remove(own);
    }
    Ok(if met? { Met::Leads(shares.drain(..).collect()) } else { Met::Stopped })
}

/// Answers the axis that leads until the line has ended.
pub(in crate::drives::grbl) fn follow(led: &Led, steps: u64, gate: &mut Gate<'_>) -> Ended {
    let mut announced = 0;
    loop {
        match led.words.recv() {
            Ok(Word::MayGo(made, about_to)) => {
                announced = about_to;
                let _ = led.leaves.send(gate(made, about_to));
            }
            Ok(Word::Ended(ended)) => return ended,
            // The thread of the axis that led is gone, and what it sent is made.
            Err(_) => {
                let most = announced.min(steps) as i64;
                let made = Made { least: 0, most, lost: true };
                return Ended { result: Err((GrblError::Unled, made)), sent: announced, rests: 0 };
            }
        }
    }
}
