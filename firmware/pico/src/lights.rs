//! The light of the board: what the node does, at a glance.

use rp2040_hal::gpio::bank0::Gpio25;
use rp2040_hal::gpio::{FunctionNull, FunctionSioOutput, Pin, PullDown};

use embedded_hal::digital::OutputPin;

/// Light on the board. It is dark for most of a second without a host, shines with one, and blinks fast in motion.
pub(crate) struct Light(Pin<Gpio25, FunctionSioOutput, PullDown>);

impl Light {
    /// Takes the pin of the light.
    pub(crate) fn new(pin: Pin<Gpio25, FunctionNull, PullDown>) -> Self {
        Self(pin.into_push_pull_output())
    }

    /// Shows the state at tick `now`, µs.
    pub(crate) fn show(&mut self, now: u64, has_host: bool, moves: bool) {
        let ms = now / 1_000;
        let shines = match (has_host, moves) {
            (_, true) => ms % 200 < 100,
            (true, false) => true,
            (false, false) => ms % 1_000 < 50,
        };
        let Ok(()) = if shines { self.0.set_high() } else { self.0.set_low() };
    }
}
