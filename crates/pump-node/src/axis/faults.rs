//! Faults: counted, and kept until a host has read them.

use pump_link::message::{AxisState, End, FaultCounts};

use super::axis::Axis;
use crate::board::Pins;

/// Faults of an axis since power-up.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Faults {
    pub(crate) counted: FaultCounts,
    read: FaultCounts,
}

impl Faults {
    /// Returns the faults that no host has confirmed.
    pub(crate) fn unread(&self) -> FaultCounts {
        self.counted.beyond(self.read)
    }

    /// Notes that a host has read so many. A host that claims more has read all.
    pub(crate) fn confirm(&mut self, read: FaultCounts) {
        self.read = self.read.largest(read.smallest(self.counted));
    }
}

impl<P: Pins, const Q: usize> Axis<P, Q> {
    /// Takes note of the emergency stop, which has cut the motor's current. It counts for an axis too that no host has
    /// configured since power-up: people may have turned its rotor meanwhile.
    pub(crate) fn estop(&mut self, now: u64) {
        self.cut(End::Estop, now);
        self.faults.counted.estop = self.faults.counted.estop.saturating_add(1);
    }

    /// Looks at the driver of an energised motor, which switches itself off when it reports a fault.
    pub(crate) fn look_at_driver(&mut self, now: u64) {
        let motor = self.actuator.motor();
        let fault = motor.is_energised() && motor.has_fault();
        if fault && self.cut(End::Driver, now) {
            self.faults.counted.driver = self.faults.counted.driver.saturating_add(1);
        }
    }

    /// Decelerates a move whose host was not heard for too long.
    pub(crate) fn dead_man(&mut self, now: u64) {
        let moves = self.state == AxisState::Moving;
        if moves || self.state == AxisState::Prepared {
            self.stop(self.move_number(), End::DeadMan, now);
        }
        if moves {
            self.faults.counted.link = self.faults.counted.link.saturating_add(1);
        }
    }

    /// Notes that a host has read so many faults. Returns those that are left.
    pub(crate) fn confirm(&mut self, read: FaultCounts) -> FaultCounts {
        self.faults.confirm(read);
        self.faults.unread()
    }
}
