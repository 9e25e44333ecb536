//! The search for the index mark: a probing move, `G38.2`.

use std::time::Duration;

use super::board::{Heard, POLL};
use super::connect::{RESET, rest};
use super::error::GrblError;
use super::jogs::{Jogs, feed_text};
use super::recovery::{HOLD, STOP_LIMIT_S};
use super::reply::{BoardState, Reply};
use crate::drives::{Gate, IndexSearch, Leave};

/// Longest wait for the banner of a board that is reset at rest.
const BANNER_LIMIT: Duration = Duration::from_secs(3);

/// Longest wait for a line that was refused with an alarm to be acknowledged.
const UNLOCK_LIMIT: Duration = Duration::from_secs(1);

/// Alarm of a search whose sensor answers before it begins.
const ANSWERS_ALREADY: u16 = 4;

/// Alarm of a search whose sensor never answers.
const NOT_FOUND: u16 = 5;

/// End of a probing move.
enum Probed {
    /// The sensor answered at this count. The motor went on to rest.
    Found(i64),
    /// The sensor did not answer.
    Nothing,
    /// The gate said stop. The motor rests.
    Asked,
}

impl Jogs<'_> {
    /// Turns until the sensor answers, all steps are made or the gate says stop, and rests.
    ///
    /// Probing moves have relative targets, which the board rounds itself. This move is a step shorter, and a
    /// jog makes the missing step.
    pub(super) fn search(&mut self, gate: &mut Gate<'_>) -> Result<IndexSearch, GrblError> {
        let delta = self.task.direction * (self.task.steps as i64 - 1);
        let far =
            GrblError::Far { count: self.task.count_after(self.task.steps), most: self.scale.most_count() };
        let target = self.scale.text(delta).ok_or(far)?;
        // Nothing moves yet: the user is heard at a board that does not answer.
        let deaf = self.board.be_deaf(false);
        let modes = self.modes();
        self.board.be_deaf(deaf);
        let modes = match modes {
            Err(GrblError::Interrupted) => return Ok(IndexSearch { made: 0, beyond: None }),
            modes => modes?,
        };
        loop {
            let leave = gate(0, self.task.steps);
            self.catch_up()?;
            match leave {
                Leave::Stop => return Ok(IndexSearch { made: 0, beyond: None }),
                Leave::Go if !self.is_looking() => break,
                Leave::Go | Leave::Wait => self.look_again()?,
            }
        }
        let feed = feed_text(self.task.steps_s * 60.0 / self.scale.steps_per_unit);
        self.note_sent(self.task.steps);
        let line = format!("G91G21G94G38.2{}{target}F{feed}", self.scale.axis.letter());
        self.probing = true;
        let probed = self.probe(gate, &line);
        if let Err(
            GrblError::Count { .. }
            | GrblError::Stalled { .. }
            | GrblError::Late { .. }
            | GrblError::NoOk { .. }
            | GrblError::StoppedElsewhere { .. },
        ) = probed
        {
            // Whatever went wrong, the move must not go on.
            self.hold()?;
        }
        self.probing = probed.as_ref().is_err_and(GrblError::ends_link);
        let probed = probed?;
        if matches!(probed, Probed::Nothing) {
            self.board.command("$X")?;
        }
        self.board.command(&modes)?;
        let place = self.board.rests_at()?;
        let net = self.net(place);
        self.made = self.possible(net).ok_or_else(|| self.astray(net))?;
        let stands = self.task.count_after(self.made);
        match probed {
            Probed::Found(count) => {
                let beyond = u64::try_from((stands - count) * self.task.direction).ok();
                let beyond = beyond.filter(|beyond| *beyond <= self.made);
                let beyond = beyond.ok_or(GrblError::Count { counted: count, expected: stands })?;
                return Ok(IndexSearch { made: self.made, beyond: Some(beyond) });
            }
            Probed::Asked => {}
            Probed::Nothing => {
                self.sent = self.made;
                self.run(gate)?;
            }
        }
        Ok(IndexSearch { made: self.made, beyond: None })
    }

    /// Waits for the second look at an impossible position, if the first was one.
    fn look_again(&mut self) -> Result<(), GrblError> {
        while self.is_looking() {
            if let Some(heard) = self.board.listen()? {
                self.take(heard)?;
            }
        }
        Ok(())
    }

    /// Returns the line that restores the present modes of the G-code parser that a probing move changes. The
    /// feed is not one of them: every line that moves has its own.
    fn modes(&mut self) -> Result<String, GrblError> {
        let said = self.board.command("$G")?;
        let modes = said.into_iter().find_map(|reply| match reply {
            Reply::Modes(modes) => Some(modes),
            _ => None,
        });
        let modes = modes.unwrap_or_default();
        let kept = ["G20", "G21", "G90", "G91", "G93", "G94", "G0", "G1"];
        let line: String = modes.split(' ').filter(|word| kept.contains(word)).collect();
        let moves = ["G0", "G1"].iter().any(|word| modes.split(' ').any(|mode| mode == *word));
        Ok(if moves { line } else { line + "G80" })
    }

    /// Sends a probing move and follows it to its end.
    fn probe(&mut self, gate: &mut Gate<'_>, line: &str) -> Result<Probed, GrblError> {
        self.board.send(line)?;
        let (mut found, mut nothing) = (None, false);
        loop {
            if self.asks_to_stop(gate) {
                self.hold()?;
                return Ok(Probed::Asked);
            }
            self.watch()?;
            match self.board.listen()? {
                Some(Heard::Reply(Reply::Alarm(NOT_FOUND))) => nothing = true,
                Some(Heard::Reply(Reply::Alarm(ANSWERS_ALREADY))) => {
                    self.unlock()?;
                    return Err(GrblError::Alarm { code: ANSWERS_ALREADY });
                }
                Some(Heard::Reply(Reply::Probe { position, found: true })) => {
                    let place = position.get(self.scale.axis.number()).copied();
                    found = place.map(|place| self.scale.count(self.scale.reported_mm(place)));
                }
                Some(Heard::Reply(Reply::Ok)) if nothing => return Ok(Probed::Nothing),
                Some(Heard::Reply(Reply::Ok)) => {
                    let missing = GrblError::NoOk { line: line.to_owned(), waited_s: 0.0 };
                    return found.map(Probed::Found).ok_or(missing);
                }
                Some(Heard::Reply(Reply::Error(code))) => {
                    return Err(GrblError::Refused { line: line.to_owned(), code });
                }
                // The report comes once the alarm is told.
                Some(Heard::Status(BoardState::Alarm, _)) => {}
                Some(heard) => {
                    self.take(heard)?;
                }
                None => {}
            }
        }
    }

    /// Waits until the line that was refused with an alarm is acknowledged, and clears the alarm.
    fn unlock(&mut self) -> Result<(), GrblError> {
        let until = self.board.now() + UNLOCK_LIMIT;
        while self.board.now() < until && !matches!(self.board.listen()?, Some(Heard::Reply(Reply::Ok))) {}
        self.board.command("$X").map(|_| ())
    }

    /// Decelerates any motion to rest: holds it until it stands, then resets, which keeps the count of a motor
    /// at rest. Returns the net steps where the motor stands.
    pub(super) fn hold(&mut self) -> Result<i64, GrblError> {
        let started = self.board.now();
        let limit_s = STOP_LIMIT_S + 2.0 * self.task.steps_s / self.task.steps_s2;
        let mut held: Option<Duration> = None;
        let mut door: Option<i64> = None;
        loop {
            let now = self.board.now();
            let waited_s = (now - started).as_secs_f64();
            if waited_s > limit_s {
                return Err(GrblError::Unstoppable { waited_s });
            }
            if held.is_none_or(|at| now - at >= POLL) {
                self.board.send_byte(HOLD)?;
                held = Some(now);
            }
            match self.board.listen()? {
                Some(Heard::Status(
                    BoardState::Hold { still: true } | BoardState::Idle | BoardState::Alarm,
                    _,
                )) => break,
                // An open door holds the motor too, and tells no end of the deceleration that all boards
                // have in common.
                Some(Heard::Status(BoardState::Door, Some(place))) => {
                    let net = self.net(place);
                    if door.replace(net) == Some(net) {
                        break;
                    }
                }
                Some(Heard::Reply(Reply::Banner(_))) => return Err(GrblError::Reset),
                _ => {}
            }
        }
        self.board.send_byte(RESET)?;
        let until = self.board.now() + BANNER_LIMIT;
        while self.board.now() < until {
            if matches!(self.board.listen()?, Some(Heard::Reply(Reply::Banner(_)))) {
                break;
            }
        }
        rest(self.board, &mut true)?;
        let place = self.board.rests_at()?;
        Ok(self.net(place))
    }
}
