//! The configuration of the board: objects and their numbers.

use super::super::codec::Argument;
use super::super::dictionary::Reason;
use super::super::parts::{DigitalOut, Endstop, Stepper, Trigger, Uart};
use super::board::Board;
use super::part::Part;

impl Board {
    /// Allocates room for objects.
    pub(super) fn allocate(&mut self, count: u32) -> Result<(), Reason> {
        if self.is_allocated {
            return Err(Reason::Allocated);
        }
        self.is_allocated = true;
        self.parts = (0..count).map(|_| None).collect();
        Ok(())
    }

    /// Makes an object. `numbers` are the arguments of its command after the object's number.
    pub(super) fn configure(&mut self, name: &str, oid: u32, numbers: &[u32]) -> Result<(), Reason> {
        let part = match (name, numbers) {
            ("config_stepper", &[step, direction, inverted, pulse]) => {
                // A pulse, and a pause of the same length, of the board's own fastest pace at least.
                let fastest = (f64::from(self.character.hz) / self.character.most_steps_s).ceil() as u64;
                self.outputs.insert(step, inverted != 0);
                self.outputs.insert(direction, false);
                Part::Stepper(Stepper::new(step, fastest.max(2 * u64::from(pulse))))
            }
            ("config_digital_out", &[pin, value, default, most]) => {
                self.outputs.insert(pin, value != 0);
                Part::DigitalOut(DigitalOut::new(pin, value != 0, default != 0, most, self.now))
            }
            ("config_trsync", []) => Part::Trigger(Trigger::default()),
            ("config_endstop", &[pin, pull]) => Part::Endstop(Endstop::new(pin, pull != 0)),
            ("config_tmcuart", &[read, _, write, bit]) => {
                Part::Uart(Uart::new(bit, Self::is_driver_line(read, write)))
            }
            _ => return Err(Reason::NoCommand),
        };
        match self.parts.get_mut(oid as usize) {
            Some(place @ None) if self.slots == 0 => *place = Some(part),
            _ => return Err(Reason::Assigned),
        }
        Ok(())
    }

    /// Ends the configuration, and makes the queue.
    pub(super) fn finalize(&mut self, crc: u32) -> Result<(), Reason> {
        if self.slots > 0 {
            return Err(Reason::Finalized);
        }
        (self.slots, self.used, self.crc) = (self.character.slots, 0, crc);
        self.tell_config();
        Ok(())
    }

    /// Tells the state of the configuration.
    pub(super) fn tell_config(&mut self) {
        let is_shutdown = u32::from(self.shutdown.is_some());
        let arguments = [u32::from(self.slots > 0), self.crc, is_shutdown, u32::from(self.slots)];
        self.tell("config", &arguments.map(Into::into));
    }

    /// Forgets the configuration. It needs a shutdown.
    pub(super) fn forget(&mut self) -> Result<(), Reason> {
        if self.shutdown.is_none() {
            return Err(Reason::NotShutdown);
        }
        self.parts.clear();
        (self.is_allocated, self.crc, self.slots, self.used) = (false, 0, 0, 0);
        self.shutdown = None;
        Ok(())
    }

    /// Tells a part of the dictionary.
    pub(super) fn identify(&mut self, offset: u32, count: u32) {
        let from = (offset as usize).min(self.dictionary.text.len());
        // A block has 64 bytes at most: 5 of its own, 1 for the message, 5 for the offset and 1 for the length.
        let count = (count as usize).min(52).min(self.dictionary.text.len() - from);
        let text = self.dictionary.text.get(from..from + count).unwrap_or_default().to_vec();
        self.tell("identify_response", &[offset.into(), Argument::Bytes(text)]);
    }
}
