//! The events of the parts at their ticks.

use super::super::dictionary::Reason;
use super::super::options::{DRIVER_LINE, SOCKETS};
use super::super::parts::{Made, TriggerEvent};
use super::board::{Board, Step};
use super::part::Part;

impl Board {
    /// Returns the tick of the next event.
    pub(in super::super) fn next(&self) -> u64 {
        let parts = self.parts.iter().flatten().filter_map(Part::next);
        parts.fold(self.stats_at, u64::min)
    }

    /// Lets everything happen up to tick `to`.
    pub(in super::super) fn advance(&mut self, to: u64) {
        loop {
            let next = self.next();
            if next > to {
                break;
            }
            self.now = self.now.max(next);
            if self.stats_at <= self.now {
                self.stats_at += 5 * u64::from(self.character.hz);
                self.tell("stats", &[5000.into(), self.character.hz.into(), 4096.into()]);
            }
            let due = |part: &Part| part.next().is_some_and(|at| at <= self.now);
            let Some(oid) = self.parts.iter().position(|part| part.as_ref().is_some_and(due)) else {
                continue;
            };
            if let Err(reason) = self.make(oid) {
                self.shut_down(reason);
            }
        }
        self.now = self.now.max(to);
    }

    /// Makes what a late board has not made yet when its host asks for it, up to the end of a group: the host has known
    /// by its clock that those steps were made.
    pub(super) fn catch_up(&mut self) {
        let groups = self.parts.iter().flatten().filter_map(|part| match part {
            Part::Trigger(trigger) => trigger.expires_at(),
            _ => None,
        });
        self.advance(groups.map(|at| at.saturating_sub(1)).fold(self.read, u64::min).max(self.now));
    }

    /// Makes the event of a part.
    fn make(&mut self, oid: usize) -> Result<(), Reason> {
        let now = self.now;
        match self.parts.get_mut(oid) {
            Some(Some(Part::Stepper(stepper))) => {
                let pin = stepper.step_pin;
                let made = stepper.make(now, self.character.hz);
                if let Some(made) = made? {
                    self.note(pin, made);
                    made.next?;
                }
            }
            Some(Some(Part::DigitalOut(output))) => {
                let pin = output.pin;
                let value = output.make(now)?;
                self.used = self.used.saturating_sub(1);
                self.outputs.insert(pin, value);
            }
            Some(Some(Part::Trigger(trigger))) => match trigger.make(now) {
                TriggerEvent::Expired(reason) => self.trigger(oid, reason),
                TriggerEvent::Report => self.report(oid),
            },
            Some(Some(Part::Endstop(endstop))) => {
                let (pin, is_pulled) = (endstop.pin, endstop.is_pulled);
                let level = self.input(pin, is_pulled);
                let Some(Some(Part::Endstop(endstop))) = self.parts.get_mut(oid) else { return Ok(()) };
                if let Some((group, reason)) = endstop.sample(level, now) {
                    self.trigger(group, reason);
                }
            }
            Some(Some(Part::Uart(uart))) => {
                let bits = uart.take();
                self.tell_bits(oid, bits);
            }
            _ => {}
        }
        Ok(())
    }

    /// Notes a step.
    fn note(&mut self, pin: u32, made: Made) {
        self.used = self.used.saturating_sub(made.freed);
        let socket = SOCKETS.iter().position(|socket| socket.step == pin).ok_or(pin);
        if let Ok(socket) = socket {
            if let Some(steps) = self.steps.get_mut(socket) {
                *steps += if made.is_forward { 1 } else { -1 };
            }
            self.stray += u64::from(!self.has_current(socket));
        }
        self.made.push(Step { socket, at: made.at, is_forward: made.is_forward });
    }

    /// Triggers a group, and reports that.
    fn trigger(&mut self, oid: usize, reason: u32) {
        if self.fire(oid, reason) {
            self.report(oid);
        }
    }

    /// Triggers a group: its steppers stop at once. Returns true if it was ready.
    pub(super) fn fire(&mut self, oid: usize, reason: u32) -> bool {
        let Some(Some(Part::Trigger(trigger))) = self.parts.get_mut(oid) else { return false };
        if !trigger.trigger(reason) {
            return false;
        }
        for part in self.parts.iter_mut().flatten() {
            if let Part::Stepper(stepper) = part
                && stepper.stops_on == Some(oid)
            {
                self.used = self.used.saturating_sub(stepper.stop());
            }
        }
        true
    }

    /// Reports the state of a group.
    fn report(&mut self, oid: usize) {
        let Some(Some(Part::Trigger(trigger))) = self.parts.get(oid) else { return };
        let arguments = [oid as u32, u32::from(trigger.can_trigger), trigger.reason, self.now as u32];
        self.tell("trsync_state", &arguments.map(Into::into));
    }

    /// Returns true if the pins are those of the drivers' line.
    pub(super) fn is_driver_line(read: u32, write: u32) -> bool {
        [read, write] == DRIVER_LINE
    }
}
