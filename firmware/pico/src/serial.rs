//! The serial port: 460,800 baud, 8 data bits, no parity, with queues for both directions.
#![allow(unsafe_code)]

use core::cell::RefCell;

use critical_section::Mutex;
use heapless::Deque;
use rp2040_hal::fugit::{HertzU32, RateExtU32};
use rp2040_hal::gpio::bank0::{Gpio0, Gpio1};
use rp2040_hal::gpio::{FunctionNull, FunctionUart, Pin, PullDown};
use rp2040_hal::pac::{self, Interrupt, NVIC, RESETS, UART0, interrupt};
use rp2040_hal::uart::{DataBits, StopBits, UartConfig, UartPeripheral};

/// Rate of the port, bit/s.
const BAUD: u32 = 460_800;

/// Bytes that arrived and wait for the thread: 22 ms of the line.
type Received = Deque<u8, 1024>;

/// Bytes that wait for the line.
type Waiting = Deque<u8, 2048>;

static RECEIVED: Mutex<RefCell<Received>> = Mutex::new(RefCell::new(Deque::new()));
static WAITING: Mutex<RefCell<Waiting>> = Mutex::new(RefCell::new(Deque::new()));

/// Serial port. Bytes that find no room are lost, as on a disturbed line, and the host sends them again.
pub(crate) struct Serial(());

impl Serial {
    /// Takes the port and its pins: transmit, then receive.
    pub(crate) fn new(
        port: UART0,
        pins: (Pin<Gpio0, FunctionNull, PullDown>, Pin<Gpio1, FunctionNull, PullDown>),
        resets: &mut RESETS,
        clock: HertzU32,
    ) -> Self {
        let pins = (pins.0.into_function::<FunctionUart>(), pins.1.into_function::<FunctionUart>());
        let config = UartConfig::new(BAUD.Hz(), DataBits::Eight, None, StopBits::One);
        let Ok(_) = UartPeripheral::new(port, pins, resets).enable(config, clock) else {
            unreachable!("the clock divides to this rate")
        };
        registers().uartimsc().modify(|_, mask| mask.rxim().set_bit().rtim().set_bit());
        // SAFETY: the interrupt uses statics alone.
        unsafe { NVIC::unmask(Interrupt::UART0_IRQ) };
        Self(())
    }

    /// Takes the next byte that arrived.
    pub(crate) fn take(&mut self) -> Option<u8> {
        critical_section::with(|section| RECEIVED.borrow_ref_mut(section).pop_front())
    }

    /// Sends bytes, or none of them if there is no room for all.
    pub(crate) fn send(&mut self, bytes: &[u8]) {
        critical_section::with(|section| {
            let mut waiting = WAITING.borrow_ref_mut(section);
            if waiting.capacity() - waiting.len() >= bytes.len() {
                let _ = bytes.iter().try_for_each(|byte| waiting.push_back(*byte));
            }
            fill(&mut waiting);
        });
    }
}

fn registers() -> &'static pac::uart0::RegisterBlock {
    // SAFETY: used by the interrupt, and by the thread within critical sections or before the interrupt is on.
    unsafe { &*UART0::ptr() }
}

/// Gives the port as many bytes as it takes. It asks for more as long as bytes wait.
fn fill(waiting: &mut Waiting) {
    let port = registers();
    while port.uartfr().read().txff().bit_is_clear() {
        let Some(byte) = waiting.pop_front() else { break };
        port.uartdr().write(|word| unsafe { word.data().bits(byte) });
    }
    port.uartimsc().modify(|_, mask| mask.txim().bit(!waiting.is_empty()));
}

#[interrupt]
fn UART0_IRQ() {
    let port = registers();
    critical_section::with(|section| {
        let mut received = RECEIVED.borrow_ref_mut(section);
        while port.uartfr().read().rxfe().bit_is_clear() {
            let word = port.uartdr().read();
            if !word.fe().bit() && !word.pe().bit() && !word.be().bit() {
                let _ = received.push_back(word.data().bits());
            }
        }
        fill(&mut WAITING.borrow_ref_mut(section));
    });
}
