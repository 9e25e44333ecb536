//! One move of the board, from rest to rest: the segments on their way, and what the board says of them.

use std::time::Duration;

use pump_link::message::{AxisState, MoveOrder};
use pump_link::sender::{Bracket, Stream};

use super::steps::Steps;
use crate::drives::node::error::NodeError;

/// Segments that are held until the board has taken them.
const HELD: usize = 256;

/// Time for which a move is loaded before it begins, in parts of a second: 0.3 s.
const LOADED: (u64, u64) = (3, 10);

/// Time from the board's last word to the tick at which a move begins, in parts of a second: 60 ms.
const BEGIN: (u64, u64) = (6, 100);

/// Move of the board.
pub(super) struct MoveFeed<'a> {
    /// Number of the move.
    pub(super) number: u32,
    pub(super) order: MoveOrder,
    pub(super) stream: Stream<HELD>,
    pub(super) bracket: Bracket,
    steps: Steps<'a>,
    /// Step of the plan up to which segments were pushed.
    pub(super) pushed: u64,
    /// Number of segments that were pushed.
    segments: u32,
    /// Ticks after each segment that was pushed before the begin.
    ticks: Vec<u64>,
    tick_hz: u64,
    /// Last state that the board has told of this move.
    pub(super) state: Option<AxisState>,
    /// True once the board has the order.
    pub(super) is_prepared: bool,
    /// True once the board was told to begin, by this axis or by another one: it may move.
    pub(super) may_move: bool,
    /// True once the board has the tick of the begin.
    pub(super) is_begun: bool,
    /// True once the board takes no more segments.
    pub(super) is_closed: bool,
    /// Tick at which the move begins together with those at other boards, once it is known.
    pub(super) begin_tick: Option<u64>,
    /// Tick before which the move cannot begin, if the board has said so.
    pub(super) earliest: u64,
    /// Time at which a stop was first asked for.
    pub(super) stop_asked_at: Option<Duration>,
    /// True once the board has taken the stop.
    pub(super) is_stopped: bool,
}

impl<'a> MoveFeed<'a> {
    /// Makes a move that was not sent yet. `steps` are those of the plan after the first `made`.
    pub(super) fn new(
        number: u32,
        order: MoveOrder,
        steps: Steps<'a>,
        made: u64,
        brake_steps: u64,
        tick_hz: u32,
    ) -> Self {
        let brake_steps = u32::try_from(brake_steps).unwrap_or(u32::MAX);
        Self {
            number,
            order,
            stream: Stream::new(order.from),
            bracket: Bracket::new(order.from, order.last, brake_steps),
            steps,
            pushed: made,
            segments: 0,
            ticks: Vec::new(),
            tick_hz: tick_hz.into(),
            state: None,
            is_prepared: false,
            may_move: false,
            is_begun: false,
            is_closed: false,
            begin_tick: None,
            earliest: 0,
            stop_asked_at: None,
            is_stopped: false,
        }
    }

    /// Pushes segments up to step `reach` of the plan, as many as there is room for.
    pub(super) fn push(&mut self, reach: u64) -> Result<(), NodeError> {
        while self.stream.room() > 0 && self.pushed < reach {
            let Some(segment) = self.steps.next(reach - self.pushed) else { return Ok(()) };
            let segment = self.stream.push(segment)?;
            self.pushed += u64::from(segment.steps());
            self.segments += 1;
            if !self.is_begun {
                let before = self.ticks.last().copied().unwrap_or(0);
                self.ticks.push(before.saturating_add(segment.duration().whole));
            }
        }
        Ok(())
    }

    /// Returns true if the board holds enough of the move for its begin: 0.3 s, a full queue, or all up to step
    /// `reach` of the plan.
    pub(super) fn is_loaded(&self, reach: u64, queue: u16) -> bool {
        let taken = self.stream.taken();
        let Some(last) = taken.checked_sub(1) else { return false };
        let ticks = self.ticks.get(last as usize).copied().unwrap_or(u64::MAX);
        ticks >= self.tick_hz * LOADED.0 / LOADED.1
            || taken >= u32::from(queue)
            || (taken == self.segments && self.pushed >= reach)
    }

    /// Returns the tick at which the move is to begin, for a board that was last heard at tick `heard_at`.
    pub(super) fn begin_at(&self, heard_at: u64) -> u64 {
        let soon = heard_at.max(self.earliest) + self.tick_hz * BEGIN.0 / BEGIN.1;
        self.begin_tick.unwrap_or(soon)
    }

    /// Returns true if the board may take further segments of the move.
    pub(super) fn takes(&self) -> bool {
        let lives = matches!(self.state, None | Some(AxisState::Prepared | AxisState::Moving));
        self.is_prepared && lives && !self.is_closed
    }
}
