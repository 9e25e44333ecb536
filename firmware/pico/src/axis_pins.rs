//! The pins of an axis, as masks of the RP2040's single-cycle I/O.
#![allow(unsafe_code)]

use pump_node::{Edge, Levels, Pins};
use rp2040_hal::pac::{IO_BANK0, PADS_BANK0, SIO};

/// First pin of the axes, and number of pins from one axis to the next.
const FIRST: u32 = 2;
const APART: u32 = 4;

/// First pin of the drivers' fault outputs.
const FIRST_FAULT: u32 = 18;

/// Pin of the emergency stop.
pub(crate) const ESTOP: u32 = 22;

/// Function of a pin that software drives (RP2040 datasheet, table 2).
const SIO_FUNCTION: u8 = 5;

/// Pins of an axis. Each is a mask of one bit.
#[derive(Debug)]
pub(crate) struct AxisPins {
    step: u32,
    direction: u32,
    enable: u32,
    index: u32,
    driver_fault: u32,
}

impl AxisPins {
    /// The pins of all axes.
    pub(crate) const ALL: [Self; crate::AXES] = [Self::of(0), Self::of(1), Self::of(2), Self::of(3)];

    /// Returns the pins of an axis.
    const fn of(axis: u32) -> Self {
        let first = FIRST + APART * axis;
        Self {
            step: 1 << first,
            direction: 1 << (first + 1),
            enable: 1 << (first + 2),
            index: 1 << (first + 3),
            driver_fault: 1 << (FIRST_FAULT + axis),
        }
    }

    /// Sets the pins of `mask`.
    #[inline(always)]
    pub(crate) fn set(mask: u32, high: bool) {
        // SAFETY: the set and clear registers change the bits of the mask alone, and no other code drives these pins.
        let sio = unsafe { &*SIO::ptr() };
        if high {
            sio.gpio_out_set().write(|word| unsafe { word.bits(mask) });
        } else {
            sio.gpio_out_clr().write(|word| unsafe { word.bits(mask) });
        }
    }
}

/// Sets step pins, those that rise all at one time.
#[inline(always)]
pub(crate) fn set_steps(edge: Edge) {
    // SAFETY: as in `AxisPins::set`.
    let sio = unsafe { &*SIO::ptr() };
    sio.gpio_out_set().write(|word| unsafe { word.bits(edge.high) });
    sio.gpio_out_clr().write(|word| unsafe { word.bits(edge.low) });
}

/// Returns true if a pin of `mask` is high.
#[inline(always)]
pub(crate) fn is_high(mask: u32) -> bool {
    // SAFETY: a read of the inputs changes nothing.
    unsafe { &*SIO::ptr() }.gpio_in().read().bits() & mask != 0
}

/// Makes every pin of the axes and the emergency stop an input. The driven ones float, so that the resistors of the
/// wiring decide; the sensors have pull-ups.
pub(crate) fn make_inputs() {
    // SAFETY: called once, before an interrupt or the serial port uses any pin.
    let (sio, io, pads) = unsafe { (&*SIO::ptr(), &*IO_BANK0::ptr(), &*PADS_BANK0::ptr()) };
    for pin in FIRST..=ESTOP {
        let sensor = pin >= FIRST_FAULT || (pin - FIRST) % APART == 3;
        sio.gpio_oe_clr().write(|word| unsafe { word.bits(1 << pin) });
        pads.gpio(pin as usize)
            .modify(|_, pad| pad.pue().bit(sensor).pde().clear_bit().ie().set_bit().od().clear_bit());
        io.gpio(pin as usize)
            .gpio_ctrl()
            .modify(|_, control| unsafe { control.funcsel().bits(SIO_FUNCTION) });
    }
}

impl Pins for AxisPins {
    fn make_outputs(&mut self, levels: Levels) {
        Self::set(self.step, levels.step);
        Self::set(self.direction, levels.direction);
        Self::set(self.enable, levels.enable);
        let mask = self.step | self.direction | self.enable;
        // SAFETY: the set register changes the bits of the mask alone.
        unsafe { &*SIO::ptr() }.gpio_oe_set().write(|word| unsafe { word.bits(mask) });
    }

    #[inline(always)]
    fn step_pin(&self) -> u32 {
        self.step
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
