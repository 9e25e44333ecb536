//! The serial port: 460,800 baud, 8 data bits, no parity, with a queue for each direction.
//!
//! The thread and the interrupt share the queues without a critical section, so the port never holds up a step.
#![allow(unsafe_code)]

use core::cell::UnsafeCell;

use heapless::spsc::{Consumer, Producer, Queue};
use rp2040_hal::fugit::{HertzU32, RateExtU32};
use rp2040_hal::gpio::bank0::{Gpio0, Gpio1};
use rp2040_hal::gpio::{FunctionNull, FunctionUart, Pin, PullDown};
use rp2040_hal::pac::{self, Interrupt, NVIC, RESETS, UART0, interrupt};
use rp2040_hal::uart::{DataBits, StopBits, UartConfig, UartPeripheral};

/// Rate of the port, bit/s.
const BAUD: u32 = 460_800;

/// Bytes that arrived and wait for the thread, 22 ms of the line.
const RECEIVED: usize = 1_024;

/// Bytes that wait for the line.
const WAITING: usize = 2_048;

/// Ends of the queues that the interrupt uses.
struct Ends {
    received: Producer<'static, u8>,
    waiting: Consumer<'static, u8>,
}

/// Place of the interrupt's ends.
struct Place(UnsafeCell<Option<Ends>>);

// SAFETY: written once, before the interrupt is on, and used by the interrupt alone afterwards.
unsafe impl Sync for Place {}

static ENDS: Place = Place(UnsafeCell::new(None));

/// Serial port, and the thread's ends of its queues.
pub(crate) struct Serial {
    received: Consumer<'static, u8>,
    waiting: Producer<'static, u8>,
}

impl Serial {
    /// Takes the port and its pins: transmit, then receive.
    pub(crate) fn new(
        port: UART0,
        pins: (Pin<Gpio0, FunctionNull, PullDown>, Pin<Gpio1, FunctionNull, PullDown>),
        resets: &mut RESETS,
        clock: HertzU32,
    ) -> Option<Self> {
        let pins = (pins.0.into_function::<FunctionUart>(), pins.1.into_function::<FunctionUart>());
        let config = UartConfig::new(BAUD.Hz(), DataBits::Eight, None, StopBits::One);
        UartPeripheral::new(port, pins, resets).enable(config, clock).ok()?;
        let received = cortex_m::singleton!(: Queue<u8, RECEIVED> = Queue::new())?;
        let waiting = cortex_m::singleton!(: Queue<u8, WAITING> = Queue::new())?;
        let ((to_thread, received), (waiting, to_line)) = (received.split(), waiting.split());
        // SAFETY: the interrupt is still off.
        unsafe { *ENDS.0.get() = Some(Ends { received: to_thread, waiting: to_line }) };
        registers().uartimsc().modify(|_, mask| mask.rxim().set_bit().rtim().set_bit());
        // SAFETY: the interrupt has its ends of the queues.
        unsafe { NVIC::unmask(Interrupt::UART0_IRQ) };
        Some(Self { received, waiting })
    }

    /// Takes the next byte that arrived.
    pub(crate) fn take(&mut self) -> Option<u8> {
        self.received.dequeue()
    }

    /// Sends bytes, or none of them if there is no room for all. A host that misses an answer asks again.
    pub(crate) fn send(&mut self, bytes: &[u8]) {
        if self.waiting.capacity() - self.waiting.len() >= bytes.len() {
            let _ = bytes.iter().try_for_each(|byte| self.waiting.enqueue(*byte));
        }
        NVIC::pend(Interrupt::UART0_IRQ);
    }
}

fn registers() -> &'static pac::uart0::RegisterBlock {
    // SAFETY: used by the interrupt, and by the thread before the interrupt is on.
    unsafe { &*UART0::ptr() }
}

/// Takes the bytes that have arrived, and gives the port as many as it takes.
#[interrupt]
fn UART0_IRQ() {
    // SAFETY: nothing else uses the place once the interrupt is on.
    let Some(ends) = (unsafe { &mut *ENDS.0.get() }) else { return };
    let port = registers();
    while port.uartfr().read().rxfe().bit_is_clear() {
        let word = port.uartdr().read();
        let disturbed = word.fe().bit() || word.pe().bit() || word.be().bit();
        if !disturbed {
            // A byte that finds no room is lost, as on a disturbed line.
            let _ = ends.received.enqueue(word.data().bits());
        }
    }
    while port.uartfr().read().txff().bit_is_clear() {
        let Some(byte) = ends.waiting.dequeue() else { break };
        port.uartdr().write(|word| unsafe { word.data().bits(byte) });
    }
    // The port asks again as soon as it has room, as long as bytes wait.
    port.uartimsc().modify(|_, mask| mask.txim().bit(ends.waiting.ready()));
}
