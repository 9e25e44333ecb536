//! The search for the index mark: a probing move, `G38.2`.

use std::time::{Duration, Instant};

use super::board::{Heard, POLL};
use super::connect::{RESET, rest};
use super::error::GrblError;
use super::jogs::{Jogs, feed_text};
use super::recovery::HOLD;
use super::reply::{Reply, State};
use crate::drives::{Gate, Sought};

/// Longest wait for a held motion to stand, in s beyond the time that it needs.
const HOLD_LIMIT_S: f64 = 8.0;

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
    /// The gate broke. The motor rests.
    Asked,
}

impl Jogs<'_> {
    /// Turns until the sensor answers, all steps are made or the gate breaks, and rests.
    ///
    /// Probing moves have relative targets, which the board rounds itself. This move is a step shorter, and a
    /// jog makes the missing step.
    pub(super) fn search(&mut self, gate: &mut Gate<'_>) -> Result<Sought, GrblError> {
        let delta = self.task.direction * (self.task.steps as i64 - 1);
        let far =
            GrblError::Far { count: self.task.count_after(self.task.steps), most: self.scale.most_count() };
        let target = self.scale.text(delta).ok_or(far)?;
        let modes = self.modes()?;
        if gate(0, self.task.steps).is_break() {
            return Ok(Sought { made: 0, beyond: None });
        }
        let feed = feed_text(self.task.steps_s * 60.0 / self.scale.steps_per_unit);
        self.sent = self.task.steps;
        let line = format!("G91G21G94G38.2{}{target}F{feed}", self.scale.axis.letter());
        self.probing = true;
        let probed = self.probe(gate, &line);
        if let Err(GrblError::Count { .. } | GrblError::Stalled { .. } | GrblError::NoOk { .. }) = probed {
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
        self.take(Heard::Status(State::Idle, Some(place)))?;
        let stands = self.task.count_after(self.made);
        match probed {
            Probed::Found(count) => {
                let beyond = u64::try_from((stands - count) * self.task.direction).ok();
                let beyond = beyond.filter(|beyond| *beyond <= self.made);
                let beyond = beyond.ok_or(GrblError::Count { counted: count, expected: stands })?;
                return Ok(Sought { made: self.made, beyond: Some(beyond) });
            }
            Probed::Asked => {}
            Probed::Nothing => {
                self.sent = self.made;
                self.run(gate)?;
            }
        }
        Ok(Sought { made: self.made, beyond: None })
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
        let mut watched = Instant::now();
        loop {
            if watched.elapsed() >= POLL {
                watched = Instant::now();
                if gate(self.made, self.sent).is_break() {
                    self.hold()?;
                    return Ok(Probed::Asked);
                }
            }
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
                Some(Heard::Status(State::Alarm, _)) => {}
                Some(heard) => {
                    self.take(heard)?;
                }
                None => self.watch()?,
            }
        }
    }

    /// Waits until the line that was refused with an alarm is acknowledged, and clears the alarm.
    fn unlock(&mut self) -> Result<(), GrblError> {
        let until = Instant::now() + Duration::from_secs(1);
        while Instant::now() < until && !matches!(self.board.listen()?, Some(Heard::Reply(Reply::Ok))) {}
        self.board.command("$X").map(|_| ())
    }

    /// Decelerates a probing move to rest: holds it until it stands, then resets, which keeps the count of a
    /// motor at rest.
    pub(super) fn hold(&mut self) -> Result<(), GrblError> {
        let started = Instant::now();
        let limit_s = HOLD_LIMIT_S + 2.0 * self.task.steps_s / self.task.steps_s2;
        let mut held: Option<Instant> = None;
        loop {
            if started.elapsed().as_secs_f64() > limit_s {
                return Err(GrblError::Unstoppable { waited_s: started.elapsed().as_secs_f64() });
            }
            if held.is_none_or(|at| at.elapsed() >= POLL) {
                self.board.send_byte(HOLD)?;
                held = Some(Instant::now());
            }
            match self.board.listen()? {
                Some(Heard::Status(State::Hold { still: true } | State::Idle | State::Alarm, _)) => break,
                Some(Heard::Reply(Reply::Banner(_))) => return Err(GrblError::Reset),
                _ => {}
            }
        }
        self.board.send_byte(RESET)?;
        let until = Instant::now() + Duration::from_secs(3);
        while Instant::now() < until {
            if matches!(self.board.listen()?, Some(Heard::Reply(Reply::Banner(_)))) {
                break;
            }
        }
        rest(self.board, &mut true)?;
        let place = self.board.rests_at()?;
        self.take(Heard::Status(State::Idle, Some(place))).map(|_| ())
    }
}
