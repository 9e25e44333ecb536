//! The light of the board: what the node does, at a glance.

use rp2040_hal::gpio::bank0::Gpio25;
use rp2040_hal::gpio::{FunctionNull, FunctionSioOutput, Pin, PullDown};

use embedded_hal::digital::OutputPin;

use crate::axis_pins::AxisPins;

/// Tenths of a second in a second, and calls in one of them.
const TENTHS: u8 = 10;
const CALLS: u8 = 100;

/// Calls of the short flash.
const FLASH: u8 = 50;

/// Pin of the light.
const LIGHT: u32 = 25;

/// Makes the light dark, for a firmware that stops for good.
pub(crate) fn darken() {
    AxisPins::set(1 << LIGHT, false);
}

/// Light on the board. It is dark for most of a second without a host, shines with one, and blinks fast in motion.
pub(crate) struct Light {
    pin: Pin<Gpio25, FunctionSioOutput, PullDown>,
    /// Tenth of the second, and calls in it. The processor divides slowly, so calls are counted.
    tenth: u8,
    calls: u8,
}

impl Light {
    /// Takes the pin of the light.
    pub(crate) fn new(pin: Pin<Gpio25, FunctionNull, PullDown>) -> Self {
        Self { pin: pin.into_push_pull_output(), tenth: 0, calls: 0 }
    }

    /// Shows the state. Call it every ms.
    pub(crate) fn show(&mut self, has_host: bool, moves: bool) {
        self.calls += 1;
        if self.calls == CALLS {
            self.calls = 0;
            self.tenth = if self.tenth + 1 == TENTHS { 0 } else { self.tenth + 1 };
        }
        let shines = match (has_host, moves) {
            (_, true) => self.tenth & 1 == 0,
            (true, false) => true,
            (false, false) => self.tenth == 0 && self.calls < FLASH,
        };
        let Ok(()) = if shines { self.pin.set_high() } else { self.pin.set_low() };
    }
}
