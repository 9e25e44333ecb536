//! The pins of an axis, and the emergency stop.
//!
//! QEMU has no GPIO there: it takes the writes and says so in its log, and reads give 0. So the emergency stop is
//! released, and a sensor's pin is low. A test reads the edges from the log. After each write the clock is read: the
//! log has no other time.

use pump_node::{Edge, Levels, Pins};

use crate::registers::{CLOCK, INPUTS, OUTPUTS};

/// Pin of the emergency stop among the inputs. It is low while the stop is released.
const ESTOP: u16 = 1 << 8;

/// Pins of an axis. Each is a mask of one bit.
#[derive(Debug)]
pub(crate) struct AxisPins {
    step: u16,
    direction: u16,
    enable: u16,
    index: u16,
    driver_fault: u16,
}

impl AxisPins {
    /// The pins of all axes.
    pub(crate) const ALL: [Self; crate::AXES] = [Self::of(0), Self::of(1), Self::of(2), Self::of(3)];

    /// Returns the pins of an axis.
    const fn of(axis: u16) -> Self {
        Self {
            step: 1 << axis,
            direction: 1 << (axis + 4),
            enable: 1 << (axis + 8),
            index: 1 << axis,
            driver_fault: 1 << (axis + 4),
        }
    }

    /// Sets the pins of `mask`.
    #[inline(always)]
    fn set(mask: u16, high: bool) {
        OUTPUTS.masked(mask).write(if high { mask.into() } else { 0 });
        CLOCK.value.read();
    }
}

/// Sets step pins, all in one write: they are in the lower byte.
#[inline(always)]
pub(crate) fn set_steps(edge: Edge) {
    OUTPUTS.masked((edge.high | edge.low) as u16).write(edge.high);
    CLOCK.value.read();
}

/// Returns true if a pin of `mask` is high.
#[inline(always)]
fn is_high(mask: u16) -> bool {
    INPUTS.inputs.read() & u32::from(mask) != 0
}

/// Returns true while the emergency stop is pressed.
#[inline(always)]
pub(crate) fn estop_is_pressed() -> bool {
    is_high(ESTOP)
}

/// Makes every pin an input.
pub(crate) fn make_inputs() {
    OUTPUTS.make_inputs.write(u16::MAX.into());
    INPUTS.make_inputs.write(u16::MAX.into());
}

impl Pins for AxisPins {
    fn make_outputs(&mut self, levels: Levels) {
        Self::set(self.step, levels.step);
        Self::set(self.direction, levels.direction);
        Self::set(self.enable, levels.enable);
        OUTPUTS.make_outputs.write((self.step | self.direction | self.enable).into());
        CLOCK.value.read();
    }

    #[inline(always)]
    fn step_pin(&self) -> u32 {
        self.step.into()
    }

    fn set_direction(&mut self, high: bool) {
        Self::set(self.direction, high);
    }

    fn set_enable(&mut self, high: bool) {
        Self::set(self.enable, high);
    }

    fn index_is_high(&mut self) -> bool {
        is_high(self.index)
    }

    fn driver_fault_is_high(&mut self) -> bool {
        is_high(self.driver_fault)
    }
}
