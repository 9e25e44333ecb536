//! The recovery of a motion that went wrong: it is stopped, and the steps made are learned if possible.

use std::time::{Duration, Instant};

use super::board::{Heard, OK_LIMIT, POLL};
use super::error::GrblError;
use super::jogs::Jogs;
use super::reply::{Reply, State};

/// Byte that cancels jogs: the motor decelerates. The board can miss it, so it is repeated.
const CANCEL: u8 = 0x85;

/// Byte that holds any motion. Nothing else stops a motion that is no jog.
pub(super) const HOLD: u8 = b'!';

/// Longest wait for the motor to rest, beyond the time that it needs, in s.
const STOP_LIMIT_S: f64 = 8.0;

/// Time for which a reset board must stand before no line can be on its way to it any more.
const AFTERMATH: Duration = Duration::from_millis(300);

/// Knowledge of the end of a motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Known {
    /// The end is known to the step.
    Exactly,
    /// The end lies between the last step that was reported and the last that was sent.
    Between,
    /// The end is unknown.
    Nowhere,
}

impl Jogs<'_> {
    /// Stops after `error`. Returns the error that remains, and how well `made` is known.
    pub(super) fn recover(&mut self, error: GrblError) -> (GrblError, Known) {
        if error.ends_link() {
            self.call_out();
            return (error, Known::Between);
        }
        if matches!(error, GrblError::Reset) {
            let at_zero = self.aftermath().unwrap_or(false);
            return (error, if at_zero { Known::Between } else { Known::Nowhere });
        }
        let reported = self.made;
        match self.stop() {
            Ok(()) if error.loses() => (error, Known::Nowhere),
            Ok(()) => (error, Known::Exactly),
            Err(also @ (GrblError::Reset | GrblError::Gone(_) | GrblError::Quiet { .. })) => {
                self.recover(also)
            }
            Err(also) if also.loses() => (also, Known::Nowhere),
            Err(_) => {
                self.made = reported;
                (error, Known::Between)
            }
        }
    }

    /// Decelerates to rest, whatever goes on. Afterwards `made` is where the motor stands.
    pub(super) fn stop(&mut self) -> Result<(), GrblError> {
        let started = Instant::now();
        let limit_s = STOP_LIMIT_S + 2.0 * self.task.steps_s / self.task.steps_s2;
        let mut cancelled: Option<Instant> = None;
        let mut rests: Option<u64> = None;
        // From now on every report must be newer than the first cancel.
        self.odd = 0;
        loop {
            if started.elapsed().as_secs_f64() > limit_s {
                return Err(GrblError::Unstoppable { waited_s: started.elapsed().as_secs_f64() });
            }
            if cancelled.is_none_or(|at| at.elapsed() >= POLL) {
                self.board.send_byte(CANCEL)?;
                self.board.ask()?;
                cancelled = Some(Instant::now());
            }
            let Some(heard) = self.board.listen()? else { continue };
            let state = match heard {
                Heard::Status(state, Some(place)) => {
                    self.see(place)?;
                    state
                }
                // Neither an acknowledged nor a refused line sets the motor in motion any more, and neither
                // does an alarm.
                Heard::Reply(Reply::Ok | Reply::Error(_)) => {
                    self.awaited = None;
                    continue;
                }
                Heard::Reply(Reply::Alarm(code)) => return Err(GrblError::Alarm { code }),
                Heard::Reply(Reply::Banner(_)) => return Err(GrblError::Reset),
                _ => continue,
            };
            let still = matches!(state, State::Idle | State::Alarm) && self.odd == 0;
            let line_pending = self.awaited.as_ref().is_some_and(|(_, since)| since.elapsed() < OK_LIMIT);
            if still && !line_pending {
                if rests == Some(self.made) {
                    return Ok(());
                }
                rests = Some(self.made);
            } else {
                rests = None;
            }
        }
    }

    /// Stops a board that was reset in motion. A line on its way may have set the motor in motion again, from
    /// zero.
    ///
    /// Returns true if the board stands at zero, so that the motor has not moved again.
    pub(super) fn aftermath(&mut self) -> Result<bool, GrblError> {
        let started = Instant::now();
        let mut cancelled: Option<Instant> = None;
        let mut rests: Option<(i64, Instant)> = None;
        while started.elapsed() < OK_LIMIT {
            if cancelled.is_none_or(|at| at.elapsed() >= POLL) {
                self.board.send_byte(CANCEL)?;
                cancelled = Some(Instant::now());
            }
            match self.board.listen()? {
                Some(Heard::Status(State::Idle | State::Alarm, Some(place))) => {
                    let counted = self.scale.count(self.scale.reported_mm(place));
                    match rests {
                        Some((count, since)) if count == counted => {
                            if since.elapsed() >= AFTERMATH {
                                return Ok(counted == 0);
                            }
                        }
                        _ => rests = Some((counted, Instant::now())),
                    }
                }
                Some(Heard::Status(..)) => rests = None,
                _ => {}
            }
        }
        Ok(false)
    }

    /// Tells a board that does not answer to stop. The board may still hear.
    pub(super) fn call_out(&mut self) {
        let stop = if self.probing { HOLD } else { CANCEL };
        for _ in 0..5 {
            if self.board.send_byte(stop).is_err() {
                return;
            }
            std::thread::sleep(POLL);
        }
    }
}
