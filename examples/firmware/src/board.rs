//! The MPS2 board with the AN386 image (ARM DAI 0386): its counter, an alarm, three pins, a delay. A port to another
//! board replaces this file, `memory.x` and `.cargo/config.toml`.

#![allow(unsafe_code, reason = "registers are touched here")]

use core::convert::Infallible;
use core::sync::atomic::{AtomicU32, Ordering::Relaxed};

use cortex_m::peripheral::{SYST, syst::SystClkSource};
use embedded_hal::delay::DelayNs;
use embedded_hal::digital::{ErrorType, OutputPin};

/// Rate at which timer 0 and SysTick count, Hz.
pub const COUNT_HZ: u32 = 25_000_000;

/// Register of the board, by its address.
#[derive(Clone, Copy)]
struct Register(usize);

const TIMER0_CTRL: Register = Register(0x4000_0000);
const TIMER0_VALUE: Register = Register(0x4000_0004);
const TIMER0_RELOAD: Register = Register(0x4000_0008);
const GPIO0_OUT_ENABLE: Register = Register(0x4001_0010);
/// Base of the pins' words. The word at `4 * mask` from here sets those of the pins 0 to 7 that are in
/// `mask`, and no others.
const GPIO0_MASKED: usize = 0x4001_0400;

impl Register {
    fn read(self) -> u32 {
        // SAFETY: made in this file only, from addresses in the board's manual where reading changes nothing.
        unsafe { (self.0 as *const u32).read_volatile() }
    }

    fn write(self, value: u32) {
        // SAFETY: made in this file only, from addresses in the board's manual; none of them changes memory.
        unsafe { (self.0 as *mut u32).write_volatile(value) }
    }
}

/// Lets timer 0 run freely.
pub fn start_counter() {
    TIMER0_RELOAD.write(u32::MAX);
    TIMER0_VALUE.write(u32::MAX);
    TIMER0_CTRL.write(1);
}

/// Returns the counts since [`start_counter`]; wraps after 171 s.
#[inline]
pub fn counts() -> u32 {
    // The timer counts down.
    !TIMER0_VALUE.read()
}

/// SysTick as an alarm that is set anew for every interrupt.
pub struct Alarm(SYST);

impl Alarm {
    pub fn new(mut timer: SYST) -> Self {
        timer.set_clock_source(SystClkSource::Core);
        timer.enable_interrupt();
        Self(timer)
    }

    /// Interrupts when [`counts`] is `at`; at once if that is past, and within 0.6 s (24 bits) in any case.
    #[inline]
    pub fn set(&mut self, at: u32) {
        let ahead = (at.wrapping_sub(counts()) as i32).clamp(1, 0xff_ffff);
        self.0.set_reload(ahead as u32);
        self.0.clear_current();
        self.0.enable_counter();
    }

    pub fn off(&mut self) {
        self.0.disable_counter();
    }
}

/// Output pin: one of the pins 0 to 7 of GPIO 0. QEMU 7.2 has no GPIO there and takes the writes.
pub struct Output {
    mask: usize,
}

impl Output {
    pub fn new(pin: usize) -> Self {
        let mask = 1 << pin;
        GPIO0_OUT_ENABLE.write(mask as u32);
        Self { mask }
    }

    fn write(&mut self, pins: u32) {
        Register(GPIO0_MASKED + 4 * self.mask).write(pins);
    }
}

impl ErrorType for Output {
    type Error = Infallible;
}

impl OutputPin for Output {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.write(0);
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.write(0xff);
        Ok(())
    }
}

/// Step pin that remembers the time at which an oscilloscope would see it rise.
pub struct StepPin(pub Output);

static ROSE_AT: AtomicU32 = AtomicU32::new(0);

impl StepPin {
    /// Returns [`counts`] at the moment at which the pin last rose.
    pub fn rose_at() -> u32 {
        ROSE_AT.load(Relaxed)
    }
}

impl ErrorType for StepPin {
    type Error = Infallible;
}

impl OutputPin for StepPin {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.0.set_low()
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.0.set_high()?;
        ROSE_AT.store(counts(), Relaxed);
        Ok(())
    }
}

/// Delay that waits by the counter, and adds up its times.
pub struct Wait;

static WAITED: AtomicU32 = AtomicU32::new(0);

impl Wait {
    /// Returns the counts waited since power-up.
    pub fn waited() -> u32 {
        WAITED.load(Relaxed)
    }
}

impl DelayNs for Wait {
    fn delay_ns(&mut self, ns: u32) {
        let began = counts();
        let wanted = ns.div_ceil(1_000_000_000 / COUNT_HZ);
        while counts().wrapping_sub(began) < wanted {}
        WAITED.store(Self::waited().wrapping_add(counts().wrapping_sub(began)), Relaxed);
    }
}
