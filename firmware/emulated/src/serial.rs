//! The serial ports, each with a queue for each direction that thread and interrupt share without a critical section.
#![allow(unsafe_code)]

use core::cell::UnsafeCell;

use cortex_m::peripheral::NVIC;
use heapless::spsc::{Consumer, Producer, Queue};

use crate::registers::{
    COUNT_HZ, Interrupt, RECEIVE_FULL, RECEIVED, SEND_FULL, SENT, UART_ALL_ON, UARTS, Uart,
};

/// Bytes that arrived and wait for the thread.
pub(crate) type Arrived = Queue<u8, 1_024>;

/// Bytes that wait for the line.
pub(crate) type Waiting = Queue<u8, 2_048>;

/// Which of the ports.
#[derive(Clone, Copy)]
pub(crate) enum Port {
    /// The link to the host.
    Link = 0,
    /// The hold that a test has on the board's time.
    Pace = 1,
}

impl Port {
    const fn uart(self) -> &'static Uart {
        &UARTS[self as usize]
    }

    const fn interrupts(self) -> [Interrupt; 2] {
        match self {
            Self::Link => [Interrupt::Uart0Received, Interrupt::Uart0Sent],
            Self::Pace => [Interrupt::Uart1Received, Interrupt::Uart1Sent],
        }
    }
}

/// Ends of the queues that the interrupt uses.
struct Ends {
    arrived: Producer<'static, u8>,
    waiting: Consumer<'static, u8>,
}

/// Place of the interrupt's ends.
struct Place(UnsafeCell<Option<Ends>>);

// SAFETY: written once, before the port's interrupts are on, and used by these alone afterwards. They have one
// priority.
unsafe impl Sync for Place {}

static ENDS: [Place; 2] = [const { Place(UnsafeCell::new(None)) }; 2];

/// Serial port, and the thread's ends of its queues.
pub(crate) struct Serial {
    port: Port,
    arrived: Consumer<'static, u8>,
    waiting: Producer<'static, u8>,
    /// Bytes that the thread has taken, and that it has sent, since the reset.
    taken: u32,
    sent: u32,
}

impl Serial {
    /// Switches a port on.
    pub(crate) fn new(port: Port, baud: u32, queues: (&'static mut Arrived, &'static mut Waiting)) -> Self {
        let ((to_thread, arrived), (waiting, to_line)) = (queues.0.split(), queues.1.split());
        // SAFETY: the port's interrupts are still off.
        unsafe { *ENDS[port as usize].0.get() = Some(Ends { arrived: to_thread, waiting: to_line }) };
        port.uart().divisor.write(COUNT_HZ / baud);
        port.uart().control.write(UART_ALL_ON);
        for interrupt in port.interrupts() {
            // SAFETY: the interrupt has its ends of the queues.
            unsafe { NVIC::unmask(interrupt) };
        }
        Self { port, arrived, waiting, taken: 0, sent: 0 }
    }

    /// Takes the next byte that arrived.
    pub(crate) fn take(&mut self) -> Option<u8> {
        let byte = self.arrived.dequeue()?;
        self.taken = self.taken.wrapping_add(1);
        Some(byte)
    }

    /// Returns true if a byte waits to be taken.
    pub(crate) fn has_byte(&self) -> bool {
        self.arrived.ready()
    }

    /// Returns the number of bytes that have arrived since the reset.
    pub(crate) fn arrived(&self) -> u32 {
        self.taken.wrapping_add(self.arrived.len() as u32)
    }

    /// Returns the number of bytes that were sent since the reset.
    pub(crate) fn sent(&self) -> u32 {
        self.sent
    }

    /// Sends bytes, or none of them if there is no room for all. A host that misses an answer asks again.
    pub(crate) fn send(&mut self, bytes: &[u8]) {
        if self.waiting.capacity() - self.waiting.len() >= bytes.len() {
            let _ = bytes.iter().try_for_each(|byte| self.waiting.enqueue(*byte));
            self.sent = self.sent.wrapping_add(bytes.len() as u32);
        }
        let [_, sent] = self.port.interrupts();
        NVIC::pend(sent);
    }
}

/// Takes the bytes that have arrived, and gives the port as many as it takes. It is called by the port's interrupts.
pub(crate) fn serve(port: Port) {
    // SAFETY: nothing else uses the place once the interrupts are on.
    let Some(ends) = (unsafe { &mut *ENDS[port as usize].0.get() }) else { return };
    let uart = port.uart();
    // Cleared before the state is looked at: a byte that comes meanwhile interrupts again.
    uart.clear.write(SENT | RECEIVED);
    while uart.state.read() & RECEIVE_FULL != 0 {
        // A byte that finds no room is lost, as on a disturbed line.
        let _ = ends.arrived.enqueue(uart.data.read() as u8);
    }
    while uart.state.read() & SEND_FULL == 0 {
        let Some(byte) = ends.waiting.dequeue() else { break };
        uart.data.write(byte.into());
    }
}
