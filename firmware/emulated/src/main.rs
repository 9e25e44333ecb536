//! The node on QEMU's mps2-an386, a Cortex-M4: the second board on which the tests dose (docs/node.md). It is a board
//! for tests, not for users.
//!
//! UART 0 is the link, UART 1 the hold that a test has on the board's time. Axis k has step on pin k of GPIO 0,
//! direction on pin 4 + k and enable on pin 8 + k. The index sensor is on pin k of GPIO 1, and the driver's fault
//! output on pin 4 + k. Pin 8 of GPIO 1 is the emergency stop.
//!
//! The alarm's interrupt makes the steps. The interrupts of the serial ports take and send bytes. Everything else is in
//! the loop below.
#![no_std]
#![no_main]

mod axis_pins;
mod mps2;
mod pace;
mod registers;
mod serial;
mod step_timer;

use core::panic::PanicInfo;

use cortex_m::peripheral::{NVIC, Peripherals, SCB, scb::SystemHandler};
use cortex_m_rt::{entry, exception};
use pump_node::{Node, identity};

use pace::Pace;
use registers::Interrupt;
use serial::{Arrived, Port, Serial, Waiting};
use step_timer::{SharedAxes, StepTimer, TICK_HZ};

/// Number of axes.
const AXES: usize = 4;

/// Number of segments that the queue of an axis holds.
const QUEUE: usize = 256;

/// Rate of the link, bit/s.
const LINK_BAUD: u32 = 460_800;

/// Rate of the port that paces the board, bit/s. It is the fastest.
const PACE_BAUD: u32 = registers::COUNT_HZ / 16;

/// Time between two looks at the dead-man time, ticks: 1 ms.
const POLL_TICKS: u64 = 1_000;

/// Cycles between two looks of a processor that stays awake, 20 us.
const LOOK_CYCLES: u32 = 2_500;

/// Number of the board. It has none of its own.
const BOARD: u64 = 0;

/// Makes a serial port with its queues.
macro_rules! serial {
    ($port:expr, $baud:expr) => {{
        let arrived = cortex_m::singleton!(: Arrived = Arrived::new());
        let waiting = cortex_m::singleton!(: Waiting = Waiting::new());
        arrived.zip(waiting).map(|queues| Serial::new($port, $baud, queues))
    }};
}

#[entry]
fn main() -> ! {
    let Some(mut cores) = Peripherals::take() else { halt() };
    axis_pins::make_inputs();
    put_steps_first(&mut cores.NVIC, &mut cores.SCB);
    let mut timer = StepTimer::new(cores.SYST);
    let Some((mut link, pace)) = serial!(Port::Link, LINK_BAUD).zip(serial!(Port::Pace, PACE_BAUD)) else {
        halt()
    };
    let mut shared = SharedAxes::new(&timer);
    let mut node = Node::new(identity::<QUEUE, AXES>(BOARD, firmware_version(), TICK_HZ));
    let mut pace = Pace::new(pace);
    let mut poll_at = 0;
    loop {
        while let Some(byte) = link.take() {
            if let Some(answer) = node.on_byte(byte, step_timer::now(), &mut shared) {
                link.send(answer.bytes());
            }
        }
        let now = step_timer::now();
        if now >= poll_at {
            poll_at = now + POLL_TICKS;
            step_timer::keep();
            node.poll(now, &mut shared);
        }
        if now >= pace.until() {
            pace.wait(&mut timer, &mut shared, &link);
        } else if !pace.holds() {
            // The processor stays awake: QEMU would wake it by the computer's clock, too late for a step.
            cortex_m::asm::delay(LOOK_CYCLES);
        } else {
            timer.sleep_until(poll_at.min(pace.until()), || link.has_byte());
        }
    }
}

/// Lets the interrupt of the steps interrupt the others.
#[allow(unsafe_code)]
fn put_steps_first(interrupts: &mut NVIC, exceptions: &mut SCB) {
    const FIRST: u8 = 0;
    const SECOND: u8 = 1 << 6;
    // SAFETY: no critical section relies on priorities.
    unsafe {
        interrupts.set_priority(Interrupt::Alarm, FIRST);
        for interrupt in
            [Interrupt::Uart0Received, Interrupt::Uart0Sent, Interrupt::Uart1Received, Interrupt::Uart1Sent]
        {
            interrupts.set_priority(interrupt, SECOND);
        }
        exceptions.set_priority(SystemHandler::SysTick, SECOND);
    }
}

/// Ends a sleep.
#[exception]
fn SysTick() {}

/// Takes every interrupt of the board.
#[allow(unsafe_code)]
#[exception]
unsafe fn DefaultHandler(number: i16) {
    match Interrupt::of(number) {
        Some(Interrupt::Alarm) => step_timer::on_alarm(),
        Some(Interrupt::Uart0Received | Interrupt::Uart0Sent) => serial::serve(Port::Link),
        Some(Interrupt::Uart1Received | Interrupt::Uart1Sent) => serial::serve(Port::Pace),
        None => halt(),
    }
}

/// Version of this firmware.
const fn firmware_version() -> [u16; 3] {
    [
        number(env!("CARGO_PKG_VERSION_MAJOR")),
        number(env!("CARGO_PKG_VERSION_MINOR")),
        number(env!("CARGO_PKG_VERSION_PATCH")),
    ]
}

/// Number that decimal digits write.
const fn number(digits: &str) -> u16 {
    match u16::from_str_radix(digits, 10) {
        Ok(number) => number,
        Err(_) => panic!("cargo gives numbers"),
    }
}

/// Stops for good. Interrupts are off, and motors hold.
fn halt() -> ! {
    cortex_m::interrupt::disable();
    loop {
        cortex_m::asm::wfi();
    }
}

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    halt()
}
