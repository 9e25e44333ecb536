//! Registers and interrupts of the MPS2 board with the AN386 image (ARM DAI 0386; the parts are those of ARM DDI 0479).
#![allow(unsafe_code)]

use cortex_m::interrupt::InterruptNumber;

/// Register of the board, by its address.
#[derive(Clone, Copy)]
pub(crate) struct Register(usize);

impl Register {
    /// Reads the register.
    #[inline(always)]
    pub(crate) fn read(self) -> u32 {
        // SAFETY: made in this file only, from addresses of the board's registers and of the strap.
        unsafe { (self.0 as *const u32).read_volatile() }
    }

    /// Writes the register.
    #[inline(always)]
    pub(crate) fn write(self, value: u32) {
        // SAFETY: made in this file only, from addresses of the board's registers, none of which changes memory.
        unsafe { (self.0 as *mut u32).write_volatile(value) }
    }
}

/// Timer that counts down from its value, and goes on from `reload` after 0.
pub(crate) struct Timer {
    pub(crate) control: Register,
    pub(crate) value: Register,
    pub(crate) reload: Register,
    /// A write of 1 ends the timer's interrupt.
    pub(crate) clear: Register,
}

impl Timer {
    const fn at(base: usize) -> Self {
        let [control, value, reload, clear] =
            [Register(base), Register(base + 4), Register(base + 8), Register(base + 0xc)];
        Self { control, value, reload, clear }
    }
}

/// Timer whose interrupt makes the steps.
pub(crate) const ALARM: Timer = Timer::at(0x4000_0000);

/// Timer that is the board's clock.
pub(crate) const CLOCK: Timer = Timer::at(0x4000_1000);

/// Rate of both timers, Hz.
pub(crate) const COUNT_HZ: u32 = 25_000_000;

/// Bits of a timer's control register.
pub(crate) const TIMER_RUNS: u32 = 1 << 0;
pub(crate) const TIMER_INTERRUPTS: u32 = 1 << 3;

/// Serial port.
pub(crate) struct Uart {
    pub(crate) data: Register,
    pub(crate) state: Register,
    pub(crate) control: Register,
    /// A write ends the interrupts of the bits that are 1.
    pub(crate) clear: Register,
    /// Counts of [`COUNT_HZ`] to a bit.
    pub(crate) divisor: Register,
}

impl Uart {
    const fn at(base: usize) -> Self {
        Self {
            data: Register(base),
            state: Register(base + 4),
            control: Register(base + 8),
            clear: Register(base + 0xc),
            divisor: Register(base + 0x10),
        }
    }
}

/// The first two serial ports.
pub(crate) const UARTS: [Uart; 2] = [Uart::at(0x4000_4000), Uart::at(0x4000_5000)];

/// Bits of a port's state, of its interrupts, and of its control register.
pub(crate) const SEND_FULL: u32 = 1 << 0;
pub(crate) const RECEIVE_FULL: u32 = 1 << 1;
pub(crate) const SENT: u32 = 1 << 0;
pub(crate) const RECEIVED: u32 = 1 << 1;
pub(crate) const UART_ALL_ON: u32 = 0b1111;

/// Sixteen pins.
pub(crate) struct Gpio {
    base: usize,
    pub(crate) inputs: Register,
    /// A write makes the pins outputs whose bits are 1.
    pub(crate) make_outputs: Register,
    /// A write makes the pins inputs whose bits are 1.
    pub(crate) make_inputs: Register,
}

impl Gpio {
    const fn at(base: usize) -> Self {
        let [inputs, make_outputs, make_inputs] =
            [Register(base), Register(base + 0x10), Register(base + 0x14)];
        Self { base, inputs, make_outputs, make_inputs }
    }

    /// Returns the register that sets the pins of `mask` and no others. It sets pins of one byte, the lower if any.
    #[inline(always)]
    pub(crate) const fn masked(&self, mask: u16) -> Register {
        let [low, high] = mask.to_le_bytes();
        let word = if low != 0 { 0x400 + 4 * low as usize } else { 0x800 + 4 * high as usize };
        Register(self.base + word)
    }
}

/// Pins of the motors' drivers.
pub(crate) const OUTPUTS: Gpio = Gpio::at(0x4001_0000);

/// Pins of the sensors.
pub(crate) const INPUTS: Gpio = Gpio::at(0x4001_1000);

/// First word of the board's PSRAM, which no program uses. The emulator's command line can put a 1 there.
pub(crate) const STRAP: Register = Register(0x2100_0000);

/// Interrupts of the board.
#[derive(Clone, Copy)]
#[repr(u16)]
pub(crate) enum Interrupt {
    Uart0Received = 0,
    Uart0Sent = 1,
    Uart1Received = 2,
    Uart1Sent = 3,
    Alarm = 8,
}

impl Interrupt {
    /// Returns the interrupt of this number.
    pub(crate) const fn of(number: i16) -> Option<Self> {
        match number {
            0 => Some(Self::Uart0Received),
            1 => Some(Self::Uart0Sent),
            2 => Some(Self::Uart1Received),
            3 => Some(Self::Uart1Sent),
            8 => Some(Self::Alarm),
            _ => None,
        }
    }
}

// SAFETY: each interrupt has a number of its own, which is the board's.
unsafe impl InterruptNumber for Interrupt {
    fn number(self) -> u16 {
        self as u16
    }
}
