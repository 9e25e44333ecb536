//! A part that the host has configured.

use super::super::parts::{DigitalOut, Endstop, Stepper, Trigger, Uart};

/// Part with an object's number.
#[derive(Debug)]
pub(super) enum Part {
    Stepper(Stepper),
    DigitalOut(DigitalOut),
    Trigger(Trigger),
    Endstop(Endstop),
    Uart(Uart),
}

impl Part {
    /// Returns the tick of the part's next event.
    pub(super) fn next(&self) -> Option<u64> {
        match self {
            Self::Stepper(stepper) => stepper.next(),
            Self::DigitalOut(output) => output.next(),
            Self::Trigger(trigger) => trigger.next(),
            Self::Endstop(endstop) => endstop.next(),
            Self::Uart(uart) => uart.next(),
        }
    }
}
