//! Motions of one board in one thread, while another thread asks their gates.

use std::panic::resume_unwind;
use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};

use pump_link::message::{AXES, AxisState, Request};

use super::motion::Motion;
use super::outcome::{Fault, Made};
use crate::drives::common_begin::{Next, Ready, Standing};
use crate::drives::node::error::NodeError;
use crate::drives::node::line::Subject;
use crate::drives::node::shared_line::SharedLine;
use crate::drives::sent_lead::{Ahead, Ends, SentLead};
use crate::drives::wire::AskClock;
use crate::drives::{BEGIN_LEAD, BeginPlace, CommonBeginError, Gate, Met};

/// Longest time between two questions to the gates, and longest wait for an answer.
const LOOK: Duration = Duration::from_millis(5);

/// Times for which there is leave ahead of a motor, and for which the board has steps. The thread that asks for leave
/// may be held up for 1 s, and the board's queue still holds 200 ms while answers are under way.
pub(in crate::drives::node) const AHEAD: Ahead = Ahead { leave_s: 1.6, sent_s: 0.6 };

/// Outcome of each motion.
type Outcomes = Vec<Result<Made, Fault>>;

/// Makes the motions of one board, each with its lead and its gate, in a thread of its own. This thread asks the gates
/// for leave meanwhile, and may be held up. Two motions or more begin at one tick, or none of them begins. One motion
/// with a place begins with those of other threads.
pub(in crate::drives::node) fn run(
    motions: Vec<Motion<'_>>,
    leads: &[SentLead<'_>],
    gates: &mut [&mut Gate<'_>],
    place: Option<BeginPlace>,
) -> Outcomes {
    let mut motions = motions;
    let takes_turns = motions.len() > 1;
    motions.iter_mut().for_each(|motion| motion.board.link.be_streaming(true, takes_turns));
    let Some(first) = motions.first_mut() else { return Vec::new() };
    let line = Arc::clone(first.board.link.shared());
    line.streams(true);
    let clock = first.board.link.ask_clock();
    let clock = clock.as_ref();
    thread::scope(|scope| {
        let _ends = Ends(leads, clock);
        let mut ask = || leads.iter().zip(gates.iter_mut()).for_each(|(lead, gate)| lead.ask(gate));
        // The thread begins with the leave that there is.
        ask();
        let streams = scope.spawn(move || {
            let _told = Told(clock, &line);
            stream(motions, place)
        });
        while clock.wait(LOOK) {
            ask();
        }
        streams.join().unwrap_or_else(|panic| resume_unwind(panic))
    })
}

/// Guard of the thread that streams: however it ends, the other thread hears of it.
struct Told<'a>(&'a dyn AskClock, &'a SharedLine);

impl Drop for Told<'_> {
    fn drop(&mut self) {
        self.0.end();
        self.1.streams(false);
    }
}

/// Gives the motions their turns until all have ended.
fn stream(mut motions: Vec<Motion<'_>>, place: Option<BeginPlace>) -> Outcomes {
    let mut outcomes: Vec<Option<Result<Made, Fault>>> = motions.iter().map(|_| None).collect();
    let mut is_together = motions.len() > 1;
    let waits = is_together || place.is_some();
    motions.iter_mut().for_each(|motion| motion.waits_for_others = waits);
    if let Some(motion) = motions.first_mut() {
        motion.place = place;
    }
    while outcomes.iter().any(Option::is_none) {
        if is_together {
            is_together = !begin(&mut motions, outcomes.iter().any(Option::is_some));
        }
        if let Some(motion) = motions.first_mut()
            && let Some(mut place) = motion.place.take()
        {
            motion.place = begin_with(motion, &mut place).then_some(place);
        }
        let going = outcomes.iter().filter(|outcome| outcome.is_none()).count().max(1) as u32;
        for (motion, outcome) in motions.iter_mut().zip(&mut outcomes) {
            if outcome.is_none() {
                *outcome = motion.turn(LOOK / going);
                if outcome.is_some() {
                    motion.lead.end();
                }
            }
        }
    }
    motions.iter_mut().for_each(|motion| motion.board.link.be_streaming(false, false));
    outcomes.into_iter().flatten().collect()
}

/// Has a motion begin at the instant at which those at other boards do. Returns false once there is nothing more to be
/// done.
fn begin_at_instant(motion: &mut Motion<'_>, place: &mut BeginPlace) -> bool {
    if motion.lead.stops() || motion.is_failing() {
        return false;
    }
    if motion.ready_at().is_none() {
        return true;
    }
    if !motion.board.link.has_clock() {
        motion.refuse(CommonBeginError::Clock.into());
        return false;
    }
    match place.meet(Instant::now(), BEGIN_LEAD) {
        Met::Waits => return true,
        Met::Failed(error) => motion.refuse(error.into()),
        Met::At(at) => match (motion.board.link.tick_at(at), &mut motion.feed) {
            (Some(tick), Some(feed)) => {
                feed.begin_tick = Some(tick);
                motion.waits_for_others = false;
            }
            _ => motion.refuse(CommonBeginError::Missed.into()),
        },
    }
    false
}

/// Begins a motion with those of other threads. Returns false once there is nothing more to be done.
fn begin_with(motion: &mut Motion<'_>, place: &mut BeginPlace) -> bool {
    if place.is_of_boards() {
        return begin_at_instant(motion, place);
    }
    let now = motion.board.link.now();
    let link = &motion.board.link;
    let (line, axis) = (Arc::as_ptr(link.shared()) as usize, link.lane());
    let feed = motion.feed.as_ref();
    let has_begun = feed.is_some_and(|feed| feed.is_begun || feed.state == Some(AxisState::Moving));
    let ready = motion.ready_at().zip(feed);
    let standing = Standing {
        ready: ready.map(|(at, feed)| Ready { line, axis, move_number: feed.number, at }),
        has_begun,
        is_refused: feed.is_some_and(|feed| feed.is_closed),
        stops: motion.lead.stops(),
    };
    let next = place.look(standing, now);
    if let Some(feed) = &mut motion.feed {
        feed.may_move |= place.is_sent();
    }
    match next {
        Next::Wait => true,
        Next::Send(all) => {
            if motion.board.link.under_way(Subject::Begin) == 0 {
                let mut moves = [0; AXES];
                for ready in &all {
                    if let Some(number) = moves.get_mut(usize::from(ready.axis)) {
                        *number = ready.move_number;
                    }
                }
                let at = all.iter().map(|ready| ready.at).max().unwrap_or(0);
                place.note_told();
                // A full window has room in the next turn.
                drop(motion.board.link.request(&Request::Begin { at, moves }, Subject::Begin));
            }
            true
        }
        Next::Begun => {
            motion.waits_for_others = false;
            if let Some(feed) = &mut motion.feed {
                feed.is_begun = true;
            }
            false
        }
        Next::Fail(error) => {
            motion.refuse(error.into());
            false
        }
    }
}

/// Begins the first moves of all motions at one tick, once the board holds enough of each. If one motion ends before,
/// the others end too. Returns true once there is nothing more to be done.
fn begin(motions: &mut [Motion<'_>], one_has_ended: bool) -> bool {
    let has_begun = motions.iter().any(|motion| motion.feed.as_ref().is_some_and(|feed| feed.is_begun));
    if has_begun {
        for motion in motions {
            motion.waits_for_others = false;
            if let Some(feed) = &mut motion.feed {
                feed.is_begun = true;
            }
        }
        return true;
    }
    if one_has_ended || motions.iter().any(|motion| motion.lead.stops()) {
        motions.iter().for_each(|motion| motion.lead.stop());
        return true;
    }
    let ready: Option<Vec<u64>> = motions.iter().map(Motion::ready_at).collect();
    let (Some(ready), Some((first, others))) = (ready, motions.split_first_mut()) else { return false };
    if first.board.link.under_way(Subject::Begin) > 0 {
        return false;
    }
    let at = ready.into_iter().max().unwrap_or(0);
    let mut moves: [u32; AXES] = first.board.moves();
    for other in others.iter() {
        moves.iter_mut().zip(other.board.moves()).for_each(|(all, own)| *all = (*all).max(own));
    }
    for motion in std::iter::once(&mut *first).chain(others.iter_mut()) {
        if let Some(feed) = &mut motion.feed {
            feed.may_move = true;
        }
    }
    let asked: Result<(), NodeError> =
        first.board.link.request(&Request::Begin { at, moves }, Subject::Begin);
    // A full window has room in the next turn.
    drop(asked);
    false
}
