//! The state of the board, its line, and its shutdown.

use std::collections::BTreeMap;

use super::super::codec::{Argument, Heard, Inlet, framed};
use super::super::dictionary::{Dictionary, Reason};
use super::super::options::{Character, SOCKETS};
use super::super::parts::Driver;
use super::part::Part;

/// Step of a motor.
#[derive(Debug, Clone, Copy)]
pub(in super::super) struct Step {
    /// Place of the socket, or the step pin where there is none.
    pub(in super::super) socket: Result<usize, u32>,
    pub(in super::super) at: u64,
    pub(in super::super) is_forward: bool,
}

/// Seconds from one `stats` to the next (src/basecmd.c).
const STATS_S: u64 = 5;

/// Board.
#[derive(Debug)]
pub(in super::super) struct Board {
    pub(super) character: Character,
    pub(super) dictionary: Dictionary,
    inlet: Inlet,
    /// Tick up to which everything has happened.
    pub(in super::super) now: u64,
    /// Tick that the board reads from its clock. It is later than `now` only while a late board makes up for it.
    pub(in super::super) read: u64,
    pub(super) parts: Vec<Option<Part>>,
    pub(super) is_allocated: bool,
    pub(super) crc: u32,
    /// Slots of the queue, 0 before the board is configured, and those in use.
    pub(super) slots: u16,
    pub(super) used: u16,
    pub(in super::super) shutdown: Option<Reason>,
    /// Reason of the last shutdown, which is told again.
    pub(super) last_reason: Reason,
    /// Levels of the outputs.
    pub(super) outputs: BTreeMap<u32, bool>,
    pub(in super::super) drivers: Vec<Driver>,
    /// True while the motors have their supply, without which their drivers say nothing.
    pub(super) has_supply: bool,
    /// Datagrams on the line to them.
    pub(in super::super) asked: u64,
    /// Steps of the motor at each socket, those in reverse taken off.
    pub(in super::super) steps: [i64; 4],
    /// Steps of motors that had no current.
    pub(in super::super) stray: u64,
    /// Most slots that were in use at once.
    pub(in super::super) most_used: u16,
    pub(super) stats_at: u64,
    /// Bytes for the host, and steps for the record.
    pub(in super::super) outgoing: Vec<u8>,
    pub(in super::super) made: Vec<Step>,
    /// True once the processor is to be reset.
    pub(in super::super) wants_reset: bool,
}

impl Board {
    /// Switches a board on at tick `now`.
    pub(in super::super) fn new(character: Character, now: u64) -> Self {
        let drivers =
            SOCKETS.iter().take(character.drivers).map(|socket| Driver::new(socket.address)).collect();
        let mut board = Self {
            dictionary: Dictionary::new(&character),
            inlet: Inlet::default(),
            now,
            read: now,
            parts: Vec::new(),
            is_allocated: false,
            crc: 0,
            slots: 0,
            used: 0,
            shutdown: None,
            last_reason: Reason::Requested,
            outputs: BTreeMap::new(),
            drivers,
            has_supply: true,
            asked: 0,
            steps: [0; 4],
            stray: 0,
            most_used: 0,
            stats_at: now + STATS_S * u64::from(character.hz),
            outgoing: Vec::new(),
            made: Vec::new(),
            wants_reset: false,
            character,
        };
        board.tell("starting", &[]);
        board
    }

    /// Returns the board after a reset of its processor at tick `now`. Drivers keep their power, motors their place.
    pub(in super::super) fn reset(self, now: u64) -> Self {
        let Self { character, drivers, has_supply, asked, steps, stray, most_used, made, .. } = self;
        Self { drivers, has_supply, asked, steps, stray, most_used, made, ..Self::new(character, now) }
    }

    /// Sends a response.
    pub(super) fn tell(&mut self, name: &str, arguments: &[Argument]) {
        let content = self.dictionary.response(name, arguments);
        self.outgoing.extend(framed(self.inlet.awaited, &content));
    }

    /// Takes a byte of the host at tick `now`.
    pub(in super::super) fn hear(&mut self, byte: u8) {
        for heard in self.inlet.take(byte) {
            if let Heard::Block(content) = heard {
                self.obey(&content);
            }
            // A block without content acknowledges, or asks for the block that is awaited.
            self.outgoing.extend(framed(self.inlet.awaited, &[]));
        }
    }

    /// Obeys the commands of a block.
    fn obey(&mut self, mut content: &[u8]) {
        while let Some((id, rest)) = content.split_first() {
            content = rest;
            let Some(shape) = self.dictionary.command(u32::from(*id)).cloned() else {
                return self.shut_down(Reason::NoCommand);
            };
            let Some(arguments) = shape.take(&mut content) else {
                return self.shut_down(Reason::Parser);
            };
            if let Err(reason) = self.command(shape.name, &arguments) {
                return self.shut_down(reason);
            }
        }
    }

    /// Shuts the board down: motors stop at once, and outputs take their defaults.
    pub(in super::super) fn shut_down(&mut self, reason: Reason) {
        if self.shutdown.is_none() {
            self.last_reason = reason;
        }
        self.shutdown = Some(self.last_reason);
        for part in self.parts.iter_mut().flatten() {
            match part {
                Part::Stepper(stepper) => {
                    stepper.stop();
                }
                Part::DigitalOut(output) => {
                    output.forget();
                    self.outputs.insert(output.pin, output.default);
                }
                Part::Trigger(trigger) => trigger.end(),
                Part::Endstop(endstop) => endstop.forget(),
                Part::Uart(uart) => uart.forget(),
            }
        }
        self.used = 0;
        let arguments = [(self.now as u32).into(), self.last_reason.id().into()];
        self.tell("shutdown", &arguments);
    }

    /// Occupies a slot of the queue.
    pub(super) fn occupy(&mut self, slots: u16) -> Result<(), Reason> {
        if self.used + slots > self.slots {
            return Err(Reason::Overflow);
        }
        self.used += slots;
        self.most_used = self.most_used.max(self.used);
        Ok(())
    }

    /// Returns true if a motor turns.
    pub(in super::super) fn is_moving(&self) -> bool {
        self.parts.iter().flatten().any(|part| matches!(part, Part::Stepper(stepper) if stepper.is_moving()))
    }

    /// Returns true once the host has configured the board.
    pub(in super::super) fn is_configured(&self) -> bool {
        self.slots > 0
    }

    /// Cuts the motors' supply, or gives it back. A driver then has the registers of its power-up; the board runs on.
    pub(in super::super) fn supply(&mut self, is_there: bool) {
        if !is_there {
            self.drivers.iter_mut().for_each(Driver::power_up);
        }
        self.has_supply = is_there;
    }

    /// Returns true if the driver of a motor has current for it. An enable pin that is no output yet has a resistor.
    pub(super) fn has_current(&self, socket: usize) -> bool {
        self.has_supply
            && SOCKETS.get(socket).is_some_and(|socket| self.outputs.get(&socket.enable) == Some(&false))
    }

    /// Returns the level of an input.
    pub(super) fn input(&self, pin: u32, is_pulled: bool) -> bool {
        match self.character.index {
            Some(sensor) if sensor.pin == pin => {
                // The mark comes half a way after the start, and is a hundredth of the way wide.
                let way = i64::from(sensor.steps).max(2);
                let steps = self.steps.get(sensor.socket).copied().unwrap_or(0);
                (steps - way / 2).rem_euclid(way) < (way / 100).max(1)
            }
            _ => is_pulled,
        }
    }
}
