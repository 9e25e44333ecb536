//! The meeting of the axes that move as one line. The last that is ready leads, and asks the others for their leave.

use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, PoisonError};
use std::thread::sleep;
use std::time::{Duration, Instant};

use super::line::AxisEnd;
use super::shared_board::AxisBoard;
use crate::drives::common_begin::{Next, Ready, Standing};
use crate::drives::grbl::error::GrblError;
use crate::drives::grbl::jogs::Follower;
use crate::drives::grbl::recovery::Made;
use crate::drives::{BeginPlace, Gate, Leave};

/// Time between two looks at the other axes.
const LOOK: Duration = Duration::from_millis(1);

/// Longest silence of the axis that leads. It waits 10 s for a leave, 8 s and a ramp for a motor to stop, and 5 s each
/// for a line and for a board that was reset.
pub(in crate::drives::grbl) const SILENCE: Duration = Duration::from_secs(60);

/// Time between two questions whether the user asks to stop, while the axis that leads says nothing.
const POLL: Duration = Duration::from_millis(50);

/// Word of the axis that leads to one that follows.
#[derive(Debug)]
pub(super) enum Word {
    /// The first number of steps are made, and those up to the second are about to be.
    MayGo(u64, u64),
    /// The line has ended.
    Ended(AxisEnd),
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

/// Answers the axis that leads until the line has ended, or the axis has said nothing for `silence`. A stop that the
/// user asks for meanwhile is the next answer.
pub(in crate::drives::grbl) fn follow(
    led: &Led,
    steps: u64,
    gate: &mut Gate<'_>,
    silence: Duration,
) -> AxisEnd {
    let (mut seen, mut announced, mut is_stopped) = (0, 0, false);
    let mut heard = Instant::now();
    loop {
        match led.words.recv_timeout(POLL.min(silence)) {
            Ok(Word::MayGo(made, about_to)) => {
                (seen, announced, heard) = (made, about_to, Instant::now());
                let leave = if is_stopped { Leave::Stop } else { gate(made, about_to) };
                is_stopped |= leave == Leave::Stop;
                let _ = led.leaves.send(leave);
            }
            Ok(Word::Ended(ended)) => return ended,
            Err(RecvTimeoutError::Timeout) if heard.elapsed() < silence => {
                is_stopped = is_stopped || gate(seen, announced) == Leave::Stop;
            }
            // The thread of the axis that led is gone or hangs, and what it sent is made.
            Err(_) => {
                let most = announced.min(steps) as i64;
                let made = Made { least: 0, most, lost: true };
                return AxisEnd { result: Err((GrblError::Unled, made)), sent: announced, rests: 0 };
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHORT: Duration = Duration::from_millis(100);

    #[test]
    fn an_axis_whose_leader_falls_silent_ends_within_the_bounds_that_were_announced() {
        let ((words, heard), (leaves, left)) = (channel(), channel());
        let led = Led { words: heard, leaves };
        words.send(Word::MayGo(10, 40)).unwrap();
        let ended = follow(&led, 900, &mut |_, _| Leave::Go, SHORT);
        assert_eq!(left.recv(), Ok(Leave::Go));
        let (error, made) = ended.result.unwrap_err();
        assert!(matches!(error, GrblError::Unled), "{error}");
        assert_eq!((made, ended.sent), (Made { least: 0, most: 40, lost: true }, 40));
    }

    #[test]
    fn a_stop_in_the_silence_of_the_leader_is_the_next_answer() {
        let ((words, heard), (leaves, left)) = (channel(), channel());
        let led = Led { words: heard, leaves };
        let (mut asked, mut later) = (0, Some(words));
        follow(
            &led,
            900,
            &mut |_, _| {
                asked += 1;
                // The leader asks again only once the user has asked to stop.
                if let Some(words) = later.take() {
                    words.send(Word::MayGo(0, 20)).unwrap();
                }
                Leave::Stop
            },
            Duration::from_secs(60),
        );
        assert_eq!((left.recv(), asked), (Ok(Leave::Stop), 1));
    }
}
