//! The commands of a host.

use super::super::codec::Argument;
use super::super::dictionary::Reason;
use super::super::options::{SOCKETS, Socket};
use super::super::parts::{Homing, Move, State, Stepper, Trigger, widened};
use super::board::Board;
use super::part::Part;

/// Commands that a board takes while it is shut down (src/basecmd.c, src/generic/armcm_reset.c).
const IN_SHUTDOWN: [&str; 8] = [
    "identify",
    "get_config",
    "get_clock",
    "get_uptime",
    "emergency_stop",
    "clear_shutdown",
    "config_reset",
    "reset",
];

impl Board {
    /// Obeys a command.
    pub(super) fn command(&mut self, name: &str, arguments: &[Argument]) -> Result<(), Reason> {
        if self.shutdown.is_some() && !IN_SHUTDOWN.contains(&name) {
            self.tell("is_shutdown", &[self.last_reason.id().into()]);
            return Ok(());
        }
        let numbers: Vec<u32> = arguments.iter().filter_map(number).collect();
        match (name, numbers.as_slice()) {
            ("identify", &[offset, count]) => self.identify(offset, count),
            ("get_config", []) => self.tell_config(),
            ("get_clock", []) => self.tell("clock", &[(self.read as u32).into()]),
            ("get_uptime", []) => {
                let (high, low) = ((self.read >> 32) as u32, self.read as u32);
                self.tell("uptime", &[high.into(), low.into()]);
            }
            ("debug_nop", []) => {}
            ("emergency_stop", []) => return Err(Reason::Requested),
            ("clear_shutdown", []) => {
                self.shutdown.take().ok_or(Reason::Cleared)?;
            }
            ("config_reset", []) => return self.forget(),
            ("reset", []) => self.wants_reset = true,
            ("allocate_oids", &[count]) => return self.allocate(count),
            ("finalize_config", &[crc]) => return self.finalize(crc),
            ("set_digital_out", &[pin, value]) => {
                self.outputs.insert(pin, value != 0);
            }
            (config, [oid, rest @ ..]) if config.starts_with("config_") => {
                return self.configure(config, *oid, rest);
            }
            ("tmcuart_send", &[oid, size]) => {
                let Some(Argument::Bytes(bits)) = arguments.get(1) else { return Err(Reason::Parser) };
                return self.send(oid, bits, size as usize);
            }
            (other, [oid, rest @ ..]) => return self.of_part(other, *oid, rest),
            _ => return Err(Reason::NoCommand),
        }
        Ok(())
    }

    /// Obeys a command to an object.
    fn of_part(&mut self, name: &str, oid: u32, numbers: &[u32]) -> Result<(), Reason> {
        let (now, place) = (self.now, oid as usize);
        match (name, numbers) {
            ("queue_step", &[interval, count, add]) => {
                let queued = Move { interval, count: count as u16, add: add as i16 };
                // The firmware takes a slot before it looks whether the move runs at once.
                self.occupy(1)?;
                let kept = self.stepper(place)?.queue(queued, now)?;
                self.used -= 1 - kept;
            }
            ("set_next_step_dir", &[dir]) => self.stepper(place)?.face(dir != 0),
            ("reset_step_clock", &[clock]) => return self.stepper(place)?.reset_clock(clock, now),
            ("stepper_get_position", []) => {
                self.catch_up();
                let position = self.stepper(place)?.position.cast_unsigned();
                self.tell("stepper_position", &[oid.into(), position.into()]);
            }
            ("stepper_stop_on_trigger", &[group]) => {
                self.trigger_of(group as usize)?;
                self.stepper(place)?.stops_on = Some(group as usize);
            }
            ("queue_digital_out", &[clock, value]) => {
                self.occupy(1)?;
                let Some(Some(Part::DigitalOut(output))) = self.parts.get_mut(place) else {
                    return Err(Reason::Oid);
                };
                return output.queue(clock, value != 0, now);
            }
            ("update_digital_out", &[value]) => {
                let Some(Some(Part::DigitalOut(output))) = self.parts.get_mut(place) else {
                    return Err(Reason::Oid);
                };
                let pin = output.pin;
                output.update(value != 0, now)?;
                self.outputs.insert(pin, value != 0);
            }
            ("endstop_home", &[clock, sample, count, rest, value, group, reason]) => {
                let group = group as usize;
                let at = widened(clock, now);
                if count > 0 {
                    self.trigger_of(group)?;
                    self.in_time(at)?;
                }
                let Some(Some(Part::Endstop(endstop))) = self.parts.get_mut(place) else {
                    return Err(Reason::Oid);
                };
                endstop.home(Homing { at, sample, count, rest, value: value != 0, group, reason });
            }
            ("endstop_query_state", []) => self.tell_endstop(oid)?,
            _ => return self.of_group(name, oid, numbers),
        }
        Ok(())
    }

    /// Obeys a command to a trigger group.
    fn of_group(&mut self, name: &str, oid: u32, numbers: &[u32]) -> Result<(), Reason> {
        let (now, place) = (self.now, oid as usize);
        match (name, numbers) {
            ("trsync_start", &[clock, every, expire_reason]) => {
                let at = widened(clock, now);
                if every > 0 {
                    self.in_time(at)?;
                }
                self.trigger_of(place)?.start(at, every, expire_reason);
                for part in self.parts.iter_mut().flatten() {
                    if let Part::Stepper(stepper) = part
                        && stepper.stops_on == Some(place)
                    {
                        stepper.stops_on = None;
                    }
                }
            }
            ("trsync_set_timeout", &[clock]) => {
                let at = widened(clock, now);
                if self.trigger_of(place)?.can_trigger {
                    self.in_time(at)?;
                }
                self.trigger_of(place)?.put_off(at);
            }
            ("trsync_trigger", &[reason]) => {
                self.trigger_of(place)?;
                self.catch_up();
                self.fire(place, reason);
                let trigger = self.trigger_of(place)?;
                trigger.end();
                // The firmware tells no clock with the state that answers the command.
                let arguments = [oid, 0, trigger.reason, 0];
                self.tell("trsync_state", &arguments.map(Into::into));
            }
            _ => return Err(Reason::NoCommand),
        }
        Ok(())
    }

    /// Refuses a tick that has passed.
    fn in_time(&self, at: u64) -> Result<(), Reason> {
        if at < self.now { Err(Reason::TooClose) } else { Ok(()) }
    }

    fn stepper(&mut self, oid: usize) -> Result<&mut Stepper, Reason> {
        match self.parts.get_mut(oid) {
            Some(Some(Part::Stepper(stepper))) => Ok(stepper),
            _ => Err(Reason::Oid),
        }
    }

    fn trigger_of(&mut self, oid: usize) -> Result<&mut Trigger, Reason> {
        match self.parts.get_mut(oid) {
            Some(Some(Part::Trigger(trigger))) => Ok(trigger),
            _ => Err(Reason::Oid),
        }
    }

    /// Sends bits to the drivers.
    fn send(&mut self, oid: u32, bits: &[u8], size: usize) -> Result<(), Reason> {
        // The firmware has room for 10 bytes.
        if bits.len() > 10 || size > 10 {
            return Err(Reason::LongUart);
        }
        let is_moving = self.is_moving();
        let (now, hz) = (self.now, self.character.hz);
        let Some(Some(Part::Uart(uart))) = self.parts.get_mut(oid as usize) else { return Err(Reason::Oid) };
        self.asked += 1;
        let drivers: &mut [_] = if self.has_supply { &mut self.drivers } else { &mut [] };
        let outputs = &self.outputs;
        uart.send(bits, size, (now, hz), |datagram| {
            // A resistor pulls an enable pin up that is no output yet.
            let is_off = |socket: &Socket| outputs.get(&socket.enable) != Some(&false);
            let state = |socket| State { is_moving, is_off: is_off(socket) };
            let mut drivers = drivers.iter_mut().zip(&SOCKETS);
            drivers.find_map(|(driver, socket)| driver.answer(datagram, state(socket)))
        });
        Ok(())
    }

    /// Tells the drivers' answer.
    pub(super) fn tell_bits(&mut self, oid: usize, bits: Vec<u8>) {
        self.tell("tmcuart_response", &[(oid as u32).into(), Argument::Bytes(bits)]);
    }

    /// Tells the state of an input.
    fn tell_endstop(&mut self, oid: u32) -> Result<(), Reason> {
        let Some(Some(Part::Endstop(endstop))) = self.parts.get(oid as usize) else {
            return Err(Reason::Oid);
        };
        let level = self.input(endstop.pin, endstop.is_pulled);
        let arguments = [oid, u32::from(endstop.is_homing), endstop.told as u32, u32::from(level)];
        self.tell("endstop_state", &arguments.map(Into::into));
        Ok(())
    }
}

/// Returns the number of an argument that is one.
fn number(argument: &Argument) -> Option<u32> {
    match argument {
        Argument::Number(number) => Some(*number),
        Argument::Bytes(_) => None,
    }
}
