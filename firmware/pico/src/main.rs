//! The node on a Raspberry Pi Pico.
//!
//! The pins are fixed (docs/node.md). GP0 and GP1 are the serial port, 460,800 baud. Axis k has step on GP(2 + 4k),
//! direction on GP(3 + 4k), enable on GP(4 + 4k), its index sensor on GP(5 + 4k), and its driver's fault output on
//! GP(18 + k). GP22 is the emergency stop: low while it is released.
//!
//! The board's own USB port is a second serial port. The processor runs at 200 MHz ([`clock`]).
//!
//! Three interrupts run. The timer's alarm 0 makes the steps. The serial port's takes and sends bytes. That of the USB
//! port wakes the loop below, which does everything else.
#![no_std]
#![no_main]

mod axis_pins;
mod boot;
mod clock;
mod critical;
mod flash_id;
mod lights;
mod pico;
mod serial;
mod step_timer;
mod usb;

use core::panic::PanicInfo;

use cortex_m_rt::{ExceptionFrame, exception};
use pump_node::{Node, identity};
use rp2040_hal::clocks::Clock;
use rp2040_hal::{Sio, entry, pac};

use lights::Light;
use serial::Serial;
use step_timer::{SharedAxes, StepTimer, TICK_HZ};
use usb::Usb;

/// Number of axes.
const AXES: usize = 4;

/// Number of segments that the queue of an axis holds.
const QUEUE: usize = 256;

/// Ports of the node: the UART, and the board's own USB port.
const UART: usize = 0;
const USB: usize = 1;

/// Time between two looks at the dead-man time, ticks: 1 ms.
const POLL_TICKS: u64 = 1_000;

#[entry]
fn main() -> ! {
    let Some((mut registers, mut cores)) = pac::Peripherals::take().zip(pac::CorePeripherals::take()) else {
        halt()
    };
    let number = flash_id::read();
    let parts = clock::Parts {
        crystal: registers.XOSC,
        clocks: registers.CLOCKS,
        system: registers.PLL_SYS,
        usb: registers.PLL_USB,
        regulator: registers.VREG_AND_CHIP_RESET,
        watchdog: registers.WATCHDOG,
    };
    let Some(clocks) = clock::set_up(parts, &mut registers.RESETS) else { halt() };
    let sio = Sio::new(registers.SIO);
    let gpio = rp2040_hal::gpio::Pins::new(
        registers.IO_BANK0,
        registers.PADS_BANK0,
        sio.gpio_bank0,
        &mut registers.RESETS,
    );
    axis_pins::make_inputs();
    step_timer::put_steps_first(&mut cores.NVIC);
    let light = Light::new(gpio.gpio25);
    let shared = SharedAxes::new(StepTimer::new(registers.TIMER, &mut registers.RESETS));
    let line = clocks.peripheral_clock.freq();
    let Some(serial) = Serial::new(registers.UART0, (gpio.gpio0, gpio.gpio1), &mut registers.RESETS, line)
    else {
        halt()
    };
    let (bus, memory) = (registers.USBCTRL_REGS, registers.USBCTRL_DPRAM);
    let Some(usb) = Usb::new(bus, memory, clocks.usb_clock, &mut registers.RESETS, number) else { halt() };
    serve(number, shared, serial, usb, light)
}

/// Serves the hosts at both ports. What it holds is not yet on the stack while the axes are made.
#[inline(never)]
fn serve(number: u64, mut shared: SharedAxes, mut serial: Serial, mut usb: Usb, mut light: Light) -> ! {
    let mut node = Node::new(identity::<QUEUE, AXES>(number, firmware_version(), TICK_HZ));
    let mut poll_at = 0;
    loop {
        while let Some(byte) = serial.take() {
            if let Some(answer) = node.on_byte_of(UART, byte, step_timer::now(), &mut shared) {
                serial.send(answer.bytes());
            }
        }
        if Usb::asks() {
            usb.serve();
        }
        while let Some(byte) = usb.take() {
            if let Some(answer) = node.on_byte_of(USB, byte, step_timer::now(), &mut shared) {
                usb.send(answer.bytes());
            }
        }
        let now = step_timer::now();
        if now >= poll_at {
            poll_at = now + POLL_TICKS;
            node.poll(now, &mut shared);
            usb.serve();
            light.show(node.is_heard(), shared.is_moving());
        }
        step_timer::sleep_until(poll_at, Usb::asks);
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
    let (bytes, mut value, mut at) = (digits.as_bytes(), 0, 0);
    while at < bytes.len() {
        value = 10 * value + (bytes[at] - b'0') as u16;
        at += 1;
    }
    value
}

/// Stops for good. Interrupts are off, motors hold, and the light is dark.
#[inline(never)]
fn halt() -> ! {
    cortex_m::interrupt::disable();
    lights::darken();
    loop {
        cortex_m::asm::wfi();
    }
}

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    halt()
}

/// A fault of the processor, such as an access to memory that is not there.
#[exception]
#[allow(unsafe_code, reason = "cortex-m-rt asks for it")]
unsafe fn HardFault(_: &ExceptionFrame) -> ! {
    halt()
}
