//! A board that was met: questions, its clock and its stepper.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use super::board_record::BoardRecord;
use super::commands::Commands;
use super::objects::Objects;
use super::session_record::SessionRecord;
use super::shared_board::SharedBoard;
use crate::drives::board_clock::{BoardClock, ClockBounds, ClockError, Reading, SharedClock};
use crate::drives::klipper::dictionary::Dictionary;
use crate::drives::klipper::error::KlipperError;
use crate::drives::klipper::fault::fault;
use crate::drives::klipper::link::Link;
use crate::drives::klipper::protocol::{Format, Message, Value};
use crate::drives::klipper::refit::StepTimer;

/// Readings of the clock after the first, so that its drift is known to some parts of 10,000.
const READINGS: u32 = 4;

/// Time between two of them.
const BETWEEN: Duration = Duration::from_millis(15);

/// Time over which the clock was read before a begin in common.
const LEARNT: Duration = Duration::from_millis(1500);

/// Reasons of a trigger group, as this drive names them. 0 is that of a group which never was ready.
pub(in crate::drives::klipper) mod reason {
    /// The motion has ended, or was brought to an end with its ramp.
    pub(in crate::drives::klipper) const ENDED: u8 = 2;
    /// A later program has ended what an earlier one left.
    pub(in crate::drives::klipper) const MET: u8 = 3;
    /// The computer fell silent.
    pub(in crate::drives::klipper) const EXPIRED: u8 = 4;
    /// The index sensor has the level that was looked for.
    pub(in crate::drives::klipper) const INDEX: u8 = 5;
}

/// State of a board's configuration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::drives::klipper) struct ConfigState {
    pub(in crate::drives::klipper) is_configured: bool,
    pub(in crate::drives::klipper) checksum: u32,
    pub(in crate::drives::klipper) is_shut_down: bool,
    /// Commands that the queue holds.
    pub(in crate::drives::klipper) slots: u16,
}

/// Link to a board whose dictionary is known.
#[derive(Debug)]
pub(in crate::drives::klipper) struct Talk {
    pub(in crate::drives::klipper) link: Link,
    pub(in crate::drives::klipper) shared: Arc<SharedBoard>,
    pub(in crate::drives::klipper) dictionary: Arc<Dictionary>,
    pub(in crate::drives::klipper) format: Arc<Commands>,
    /// Objects of the motor.
    pub(in crate::drives::klipper) objects: Objects,
}

impl Talk {
    /// Takes the messages that nobody waits for. Returns the fault that one of them tells.
    pub(in crate::drives::klipper) fn hear(&mut self) -> Result<(), KlipperError> {
        while let Some(arrival) = self.link.take() {
            for message in self.dictionary.read(&arrival.content)? {
                fault(&message, &self.dictionary)?.map_or(Ok(()), Err)?;
            }
        }
        Ok(())
    }

    /// Forgets the messages that nobody waits for.
    pub(in crate::drives::klipper) fn forget(&mut self) {
        while self.link.take().is_some() {}
    }

    /// Asks at rest, and returns the answer of this name that is of `object`, if it is of one, with the times between
    /// which the board answered, if they are known.
    fn ask_for(
        &mut self,
        question: &Format,
        values: &[Value<'_>],
        (answer, object): (&str, Option<u8>),
        heeds_faults: bool,
    ) -> Result<(Message, Option<(Duration, Duration)>), KlipperError> {
        let dictionary = Arc::clone(&self.dictionary);
        self.link.ask(question, values, |link, number, arrival| {
            for message in dictionary.read(&arrival.content)? {
                if message.name() == answer && is_of(&message, object) {
                    return Ok(Some((message, link.answered_within(number, arrival))));
                }
                if heeds_faults {
                    fault(&message, &dictionary)?.map_or(Ok(()), Err)?;
                }
            }
            Ok(None)
        })
    }

    /// Asks at rest, and hears of a shutdown or a reset instead of the answer.
    pub(in crate::drives::klipper) fn ask(
        &mut self,
        question: &Format,
        values: &[Value<'_>],
        answer: &str,
        object: Option<u8>,
    ) -> Result<Message, KlipperError> {
        Ok(self.ask_for(question, values, (answer, object), true)?.0)
    }

    /// Takes the line to the stepper drivers. Returns false while another motor has it.
    pub(super) fn take_line(&self) -> bool {
        self.shared.take_line(self.link.number())
    }

    /// Waits for the line to the stepper drivers at rest. Another motor has it for some milliseconds.
    pub(super) fn wait_for_line(&mut self) -> Result<(), KlipperError> {
        while !self.take_line() {
            self.link.sleep(BETWEEN / 5);
            self.hear()?;
        }
        Ok(())
    }

    /// Gives the line to the stepper drivers back.
    pub(in crate::drives::klipper) fn free_line(&self) {
        self.shared.free_line(self.link.number());
    }

    /// Tells the board something at rest, which it has taken afterwards.
    pub(in crate::drives::klipper) fn tell(
        &mut self,
        command: &Format,
        values: &[Value<'_>],
    ) -> Result<(), KlipperError> {
        self.link.queue(&command.encode(values)?)?;
        self.link.settle()
    }

    /// Returns the state of the configuration, in a shutdown too.
    pub(in crate::drives::klipper) fn config(&mut self) -> Result<ConfigState, KlipperError> {
        let question = self.format.get_config.clone();
        let (answer, _) = self.ask_for(&question, &[], ("config", None), false)?;
        Ok(ConfigState {
            is_configured: answer.number("is_config")? != 0,
            checksum: answer.unsigned("crc")?,
            is_shut_down: answer.number("is_shutdown")? != 0,
            slots: answer.unsigned("move_count")?.try_into().unwrap_or(u16::MAX),
        })
    }

    /// Returns the count of the stepper, by the levels of the direction pin.
    pub(in crate::drives::klipper) fn position(&mut self) -> Result<i64, KlipperError> {
        let (question, stepper) = (self.format.stepper_get_position.clone(), self.objects.stepper);
        let answer = self.ask(&question, &[stepper.into()], "stepper_position", Some(stepper))?;
        Ok(answer.number("pos")?)
    }

    /// Ends what the dead-man group watches, and stops the stepper. Returns the reason for which the group has ended:
    /// the one that is given, unless it ended before.
    pub(in crate::drives::klipper) fn end_dead_man(&mut self, reason: u8) -> Result<u8, KlipperError> {
        let question = self.format.trsync_trigger.clone();
        let group = self.objects.dead_man;
        let values = [group.into(), reason.into()];
        let answer = self.ask(&question, &values, "trsync_state", Some(group))?;
        Ok(answer.unsigned("trigger_reason")?.try_into().unwrap_or(0))
    }

    /// Ends a shutdown. Returns false if the firmware cannot.
    pub(in crate::drives::klipper) fn clear_shutdown(&mut self) -> Result<bool, KlipperError> {
        if !self.dictionary.has_command("clear_shutdown") {
            return Ok(false);
        }
        // Each other motor of this process has lost its current too, and nothing else tells it afterwards.
        self.shared.note_cut();
        let command = self.dictionary.command("clear_shutdown")?;
        self.tell(&command, &[])?;
        self.forget();
        Ok(!self.config()?.is_shut_down)
    }

    /// Reads the clock anew, as of nothing known.
    pub(in crate::drives::klipper) fn read_clock(&mut self, hz: u32) -> Result<SharedClock, KlipperError> {
        let clock = SharedClock::new(self.read_first(hz)?);
        for _ in 0..READINGS {
            self.link.sleep(BETWEEN);
            self.follow_clock(&clock)?;
        }
        Ok(clock)
    }

    /// Reads the clock in full.
    fn read_first(&mut self, hz: u32) -> Result<BoardClock, KlipperError> {
        let question = self.format.get_uptime.clone();
        loop {
            let (answer, times) = self.ask_for(&question, &[], ("uptime", None), true)?;
            // A question that was asked twice has no times.
            let Some((from, to)) = times else { continue };
            let ticks = u64::from(answer.unsigned("high")?) << 32 | u64::from(answer.unsigned("clock")?);
            return Ok(BoardClock::new(hz, ClockBounds::default(), Reading { from, to, ticks })?);
        }
    }

    /// Takes a further reading of the clock.
    pub(in crate::drives::klipper) fn follow_clock(
        &mut self,
        clock: &SharedClock,
    ) -> Result<(), KlipperError> {
        let question = self.format.get_clock.clone();
        loop {
            let (answer, times) = self.ask_for(&question, &[], ("clock", None), true)?;
            if let Some((from, to)) = times {
                clock.take(Reading { from, to, ticks: answer.unsigned("clock")? })?;
                return Ok(());
            }
        }
    }
}

/// Board that was met and configured.
#[derive(Debug)]
pub(in crate::drives::klipper) struct Board {
    pub(in crate::drives::klipper) talk: Talk,
    pub(in crate::drives::klipper) clock: SharedClock,
    /// True once the clock was read for so long that its drift moves no begin in common.
    pub(super) has_drift: bool,
    /// Ticks of a second.
    pub(in crate::drives::klipper) hz: u32,
    /// Commands that the queue holds.
    pub(in crate::drives::klipper) slots: u16,
    pub(in crate::drives::klipper) timer: StepTimer,
    /// Motors of this process that the board turns, this one among them.
    pub(in crate::drives::klipper) motors: usize,
    /// Most steps a second of several motors together.
    pub(in crate::drives::klipper) all_steps_s: f64,
    /// Shutdowns that motors of this process had ended when the board was met.
    pub(super) cuts: u32,
    /// Session as it is on record.
    pub(in crate::drives::klipper) record: SessionRecord,
    /// File of that record.
    pub(in crate::drives::klipper) path: Option<PathBuf>,
    /// File of the record that the motors of the board share.
    pub(super) shared_path: Option<PathBuf>,
    /// True if forward is the low level of the direction pin.
    pub(in crate::drives::klipper) is_reversed: bool,
    /// Level of the output that gives the motor current. `None` if the motor always has it.
    pub(in crate::drives::klipper) current_on: Option<bool>,
    /// Level of the index sensor at its mark.
    pub(in crate::drives::klipper) index_level: bool,
    /// Rate of the line, in bytes per second.
    pub(in crate::drives::klipper) bytes_s: u32,
    /// Time without a word of this program after which the board stops the motor.
    pub(in crate::drives::klipper) dead_man: Duration,
    /// Longest search for the board once it is silent in motion.
    pub(in crate::drives::klipper) search: Duration,
    /// Address of the stepper driver, if its settings are written over its line.
    pub(in crate::drives::klipper) driver: Option<u8>,
}

impl Board {
    /// Returns the count of the stepper, positive toward the outlet.
    pub(in crate::drives::klipper) fn position(&mut self) -> Result<i64, KlipperError> {
        let position = self.talk.position()?;
        Ok(if self.is_reversed { -position } else { position })
    }

    /// Gives the motor current, or takes it away. A motor that always has it stays as it is.
    pub(in crate::drives::klipper) fn set_current(&mut self, is_on: bool) -> Result<(), KlipperError> {
        let Some(on) = self.current_on else { return Ok(()) };
        let command = self.talk.format.update_digital_out.clone();
        let enable = self.talk.objects.enable;
        self.talk.tell(&command, &[enable.into(), (on == is_on).into()])
    }

    /// Puts the session on record as it is now.
    pub(in crate::drives::klipper) fn put_on_record(
        &mut self,
        record: SessionRecord,
    ) -> Result<(), KlipperError> {
        self.record = record;
        self.path.as_ref().map_or(Ok(()), |path| record.write(path))
    }

    /// Puts on record that a shutdown has taken the current away, which nothing else tells once it is ended. `is_new`
    /// is true for one that is still to be ended.
    pub(in crate::drives::klipper) fn note_cut(&mut self, is_new: bool) -> Result<(), KlipperError> {
        let cuts = match is_new {
            true => BoardRecord::note_cut(self.shared_path.as_deref(), self.record.cuts)?,
            false => self.record.cuts,
        };
        let record = SessionRecord { has_current: false, cuts, ..self.record };
        self.put_on_record(record)
    }

    /// Puts on record that the board was reset in motion, for the other pumps that it turns.
    pub(in crate::drives::klipper) fn note_reset(&self) -> Result<(), KlipperError> {
        BoardRecord::note_reset(self.shared_path.as_deref())
    }

    /// Reads the clock until its readings span so long that its drift moves no begin in common. A board that was met
    /// long ago has them.
    pub(in crate::drives::klipper) fn learn_drift(&mut self) -> Result<(), KlipperError> {
        let began = self.talk.link.now();
        // A clock forgets readings that tell nothing more, so its span alone may never be so long.
        while !self.has_drift && self.clock.span() < LEARNT {
            self.talk.link.sleep(BETWEEN);
            self.talk.follow_clock(&self.clock)?;
            self.has_drift = self.talk.link.now().saturating_sub(began) >= LEARNT;
        }
        self.has_drift = true;
        Ok(())
    }

    /// Refuses a board of which another motor of this process has ended a shutdown since this one met it.
    pub(in crate::drives::klipper) fn check_current(&self) -> Result<(), KlipperError> {
        if self.talk.shared.cuts() == self.cuts {
            return Ok(());
        }
        Err(KlipperError::Shutdown { reason: "in a motion of another pump of the board".to_owned() })
    }

    /// Refuses a board that was reset, shut down or configured by another program since it was met. Follows its clock.
    pub(in crate::drives::klipper) fn check(&mut self) -> Result<(), KlipperError> {
        self.talk.link.turn(Duration::ZERO)?;
        self.talk.hear()?;
        self.check_current()?;
        let state = self.talk.config()?;
        if !state.is_configured || state.checksum != self.record.checksum {
            return Err(KlipperError::Reset);
        }
        match self.talk.follow_clock(&self.clock) {
            Err(KlipperError::Clock(ClockError::Stale { .. })) => {
                self.clock.renew(self.talk.read_first(self.hz)?);
                self.has_drift = false;
                self.talk.follow_clock(&self.clock)
            }
            followed => followed,
        }
    }
}

/// Returns true if a message is of an object, where one is named.
fn is_of(message: &Message, object: Option<u8>) -> bool {
    object.is_none_or(|object| message.number("oid").is_ok_and(|number| number == i64::from(object)))
}
