//! A board that was met: its link, its identity and its axis.

use std::time::Duration;

use pump_ctl::step::TickRate;
use pump_link::message::{AXES, Answer, AxisStatus, Identity, Request};

use super::error::NodeError;
use super::line::Reply;
use super::link::Link;

/// Time over which the board's clock is read before a motion that begins together with those at other boards, so that
/// its drift moves no begin.
const LEARNT: Duration = Duration::from_millis(1500);

/// Time between two readings of the clock.
const BETWEEN: Duration = Duration::from_millis(15);

/// Board that holds the session of its record.
#[derive(Debug)]
pub(super) struct Board {
    pub(super) link: Link,
    pub(super) identity: Identity,
    pub(super) tick_rate: TickRate,
    /// Number of the axis, from 0.
    pub(super) axis: u8,
    /// Number of the axis's last move.
    pub(super) move_number: u32,
    /// Revision of the axis's configuration.
    pub(super) revision: u32,
    /// Rate of the port, in bits per second.
    pub(super) baud: u32,
    /// Dead-man time, ms.
    pub(super) dead_man_ms: u16,
    /// Longest search for the board once it is silent in motion.
    pub(super) patience: Duration,
}

impl Board {
    /// Returns the moves of a request that names this axis alone.
    pub(super) fn moves(&self) -> [u32; AXES] {
        let mut moves = [0; AXES];
        if let Some(number) = moves.get_mut(usize::from(self.axis)) {
            *number = self.move_number;
        }
        moves
    }

    /// Asks at rest, and refuses the answer of a board that has lost the session.
    pub(super) fn ask(&mut self, request: &Request<'_>) -> Result<Reply, NodeError> {
        let reply = self.link.ask(request)?;
        self.holds(&reply)?;
        Ok(reply)
    }

    /// Returns the state of the axis at rest.
    pub(super) fn status(&mut self) -> Result<(AxisStatus, u64), NodeError> {
        let reply = self.ask(&Request::Status { axis: self.axis })?;
        match reply.answer {
            Answer::Status(status) => Ok((status, reply.received_at)),
            Answer::Refused(refusal) => Err(NodeError::of(refusal)),
            _ => Err(NodeError::Answer),
        }
    }

    /// Reads the board's clock until its readings span so long that its drift moves no begin in common. A board that
    /// was met long ago has them, and is asked once more.
    pub(super) fn learn_clock(&mut self) -> Result<(), NodeError> {
        let began = self.link.now();
        loop {
            let span = self.link.follow_clock();
            self.status()?;
            if span >= LEARNT || self.link.now().saturating_sub(began) >= LEARNT {
                return Ok(());
            }
            self.link.pass(BETWEEN)?;
        }
    }

    /// Refuses the answer of a board that has lost the session.
    pub(super) fn holds(&self, reply: &Reply) -> Result<(), NodeError> {
        if reply.session == self.link.session() { Ok(()) } else { Err(NodeError::Reset) }
    }
}
