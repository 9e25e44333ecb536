//! The recovery of a motion that went wrong: it is stopped, and the steps made are learned if possible.

use std::time::Duration;

use super::board::{Heard, OK_LIMIT, POLL};
use super::code::stops_at_once;
use super::error::GrblError;
use super::jogs::Jogs;
use super::reply::{BoardState, Reply};

/// Byte that cancels jogs: the motor decelerates. The board can miss it, so it is repeated.
const CANCEL: u8 = 0x85;

/// Byte that holds any motion. Nothing else stops a motion that is no jog.
pub(super) const HOLD: u8 = b'!';

/// Longest wait for the motor to rest, beyond the time that it needs, in s.
pub(super) const STOP_LIMIT_S: f64 = 8.0;

/// Time for which a reset board must stand before no line can be on its way to it any more.
const AFTERMATH: Duration = Duration::from_millis(300);

/// Factor by which a motor that went astray may be faster than the board's settings allow.
const FASTER: f64 = 2.0;

/// Time by which a report may be late.
const STALE: Duration = Duration::from_millis(500);

/// Bounds of the net steps that a motion made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Made {
    pub(crate) least: i64,
    pub(crate) most: i64,
    /// True if nobody knows where the rotor stands.
    pub(crate) lost: bool,
}

impl Made {
    /// Returns the bounds of exactly `net` steps.
    pub(super) fn exactly(net: i64) -> Self {
        Self { least: net, most: net, lost: false }
    }

    /// Returns the net steps if they are known exactly.
    pub(super) fn known(self) -> Option<i64> {
        (self.least == self.most && !self.lost).then_some(self.least)
    }
}

impl Jogs<'_> {
    /// Stops after `error`. Returns the error that remains, and the steps made.
    pub(super) fn recover(&mut self, error: GrblError) -> (GrblError, Made) {
        let (made, sent) = (self.made as i64, self.sent as i64);
        let between = Made { least: made, most: sent, lost: error.loses() };
        if self.sent == 0 && !matches!(error, GrblError::Count { .. }) {
            return (error, Made { lost: between.lost, ..Made::exactly(0) });
        }
        if error.ends_link() {
            self.board.call_out(if self.probing { HOLD } else { CANCEL });
            return (error, between);
        }
        if matches!(error, GrblError::Reset) {
            let moved = self.aftermath();
            return (error, Made::after_reset(between, moved));
        }
        match self.stop() {
            Ok(net) if matches!(error, GrblError::Count { .. }) => (error, self.astray_bounds(net)),
            Ok(net) => match self.possible(net) {
                Some(_) if error.loses() => (error, between),
                Some(_) if self.alarm.is_some_and(stops_at_once) => (error, Made { lost: true, ..between }),
                Some(_) if self.doubtful => {
                    let most = net.max(self.acknowledged as i64);
                    (error, Made { least: net, most, lost: true })
                }
                Some(_) => (error, Made::exactly(net)),
                None => (self.astray(net), self.astray_bounds(net)),
            },
            // The first error says more than the silence after it. A board that is locked may fall silent.
            Err(also) if also.ends_link() && error.loses() => (error, self.unstopped(between)),
            Err(also @ (GrblError::Reset | GrblError::Gone(_) | GrblError::Quiet { .. })) => {
                self.recover(also)
            }
            Err(_) => (error, self.unstopped(between)),
        }
    }

    /// Decelerates to rest on request. Afterwards `made` is where the motor stands.
    pub(super) fn stop_here(&mut self) -> Result<(), GrblError> {
        let net = self.stop()?;
        if let Some(code) = self.alarm {
            return Err(GrblError::Alarm { code });
        }
        self.made = self.possible(net).ok_or_else(|| self.astray(net))?;
        Ok(())
    }

    /// Decelerates to rest, whatever goes on. Returns the net steps where the motor stands, as the board
    /// counts them.
    fn stop(&mut self) -> Result<i64, GrblError> {
        let started = self.board.now();
        let limit_s = STOP_LIMIT_S + 2.0 * self.task.steps_s / self.task.steps_s2;
        let mut cancelled: Option<Duration> = None;
        // From now on every report must be newer than the first cancel.
        let mut rests: Option<i64> = None;
        loop {
            let now = self.board.now();
            let waited_s = (now - started).as_secs_f64();
            if waited_s > limit_s {
                return Err(GrblError::Unstoppable { waited_s });
            }
            if cancelled.is_none_or(|at| now - at >= POLL) {
                self.board.send_byte(CANCEL)?;
                self.board.ask()?;
                cancelled = Some(now);
            }
            let (state, net) = match self.board.listen()? {
                Some(Heard::Status(state, Some(place))) => (state, self.net(place)),
                // Neither an acknowledged nor a refused line sets the motor in motion any more, and neither
                // does an alarm.
                Some(Heard::Reply(Reply::Ok | Reply::Error(_))) => {
                    self.awaited = None;
                    continue;
                }
                Some(Heard::Reply(Reply::Alarm(code))) => {
                    self.alarm = Some(code);
                    continue;
                }
                Some(Heard::Reply(Reply::Banner(_))) => return Err(GrblError::Reset),
                _ => continue,
            };
            if matches!(state, BoardState::Hold { .. } | BoardState::Door) {
                return self.hold();
            }
            let still = matches!(state, BoardState::Idle | BoardState::Alarm | BoardState::Sleep);
            let line_pending = self.awaited.as_ref().is_some_and(|(_, since)| now - *since < OK_LIMIT);
            if !still || line_pending {
                rests = None;
            } else if rests == Some(net) {
                return Ok(net);
            } else {
                rests = Some(net);
            }
        }
    }

    /// Stops a board that was reset in motion. A line on its way may have set the motor in motion again, from
    /// zero.
    ///
    /// Returns the net steps that the motor has made since the reset. `None` if the board does not tell.
    fn aftermath(&mut self) -> Option<i64> {
        let started = self.board.now();
        let mut cancelled: Option<Duration> = None;
        let mut rests: Option<(i64, Duration)> = None;
        loop {
            let now = self.board.now();
            if now - started >= OK_LIMIT {
                return None;
            }
            if cancelled.is_none_or(|at| now - at >= POLL) {
                self.board.send_byte(CANCEL).ok()?;
                cancelled = Some(now);
            }
            match self.board.listen().ok()? {
                Some(Heard::Status(BoardState::Idle | BoardState::Alarm, Some(place))) => {
                    let counted = self.scale.count(self.scale.reported_mm(place));
                    match rests {
                        Some((count, since)) if count == counted => {
                            if now - since >= AFTERMATH {
                                return Some(counted * self.task.direction);
                            }
                        }
                        _ => rests = Some((counted, now)),
                    }
                }
                Some(Heard::Status(..)) => rests = None,
                _ => {}
            }
        }
    }

    /// Returns the bounds of a motor that rests after `net` steps by the board's count, and was told to be
    /// where no line that was sent leads.
    ///
    /// If the motor went there, the count is right. If the counter jumped, the motor is as far from the count
    /// as it was from the report. It was on the way that was sent then, or had gone from there to where the
    /// counter led it since the last report that was right. The bounds hold both, as far as a motor comes in
    /// the time.
    fn astray_bounds(&mut self, net: i64) -> Made {
        let (made, sent) = (self.made as i64, self.sent as i64);
        let (strayed, at) = self.strayed.unwrap_or((net, self.confirmed));
        let unseen_s = at.saturating_sub(self.confirmed).as_secs_f64();
        let way = (self.task.steps_s * unseen_s).min(1e12) as i64;
        let (least, most) = (net.min(net - strayed + made - way), net.max(net - strayed + sent + way));
        let (slowest, farthest) = self.reach();
        let (least, most) = (least.max(slowest), most.min(farthest));
        if least > most {
            return Made { least: made, most: sent, lost: true };
        }
        Made { least, most, lost: true }
    }

    /// Returns the net steps between which the motor can stand by now.
    fn reach(&mut self) -> (i64, i64) {
        let time_s = (self.board.now() - self.confirmed + STALE).as_secs_f64();
        let way =
            (FASTER * self.task.most_steps_s * time_s).min(1e12) as i64 + 2 * (self.sent - self.made) as i64;
        (self.made as i64 - way, self.made as i64 + way)
    }

    /// Returns the bounds of a motor that may be under way still, to where lines that were sent lead.
    fn unstopped(&self, between: Made) -> Made {
        match self.strayed {
            Some((strayed, _)) => {
                Made { least: between.least.min(strayed), most: between.most.max(strayed), lost: true }
            }
            None => between,
        }
    }
}

impl Made {
    /// Returns the bounds of a motion `between` bounds that a reset ended, with `moved` net steps after it.
    fn after_reset(between: Self, moved: Option<i64>) -> Self {
        let moved = moved.map(|moved| (moved.min(0), moved.max(0)));
        let (back, on) = moved.unwrap_or((0, 0));
        Self { least: between.least + back, most: between.most + on, lost: moved != Some((0, 0)) }
    }
}
