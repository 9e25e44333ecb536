//! The Pico's own USB port: a serial port of the class CDC-ACM beside the UART.
//!
//! The thread serves the port. Its interrupt only wakes the thread, so that steps wait for no packet: critical sections
//! are those of the bus alone, one packet each.
#![allow(unsafe_code)]

use core::sync::atomic::{AtomicBool, Ordering};

use heapless::Deque;
use rp2040_hal::clocks::UsbClock;
use rp2040_hal::pac::{Interrupt, NVIC, RESETS, USBCTRL_DPRAM, USBCTRL_REGS, interrupt};
use rp2040_hal::usb::UsbBus;
use usb_device::LangID;
use usb_device::bus::UsbBusAllocator;
use usb_device::device::{StringDescriptors, UsbDevice, UsbDeviceBuilder, UsbDeviceState, UsbVidPid};
use usbd_serial::{CdcAcmClass, USB_CLASS_CDC};

/// Vendor and product: the test id of pid.codes (docs/node.md).
const ID: UsbVidPid = UsbVidPid(0x1209, 0x0001);

/// Names of the board. Linux makes /dev/serial/by-id/usb-pump-dose_node_NUMBER-if00 of them and the board's number.
const MANUFACTURER: &str = "pump-dose";
const PRODUCT: &str = "node";

/// Bytes of a packet at full speed.
const PACKET: usize = 64;

/// Bytes that wait for the host.
const WAITING: usize = 2_048;

/// Hexadecimal digits of the board's number.
const DIGITS: usize = 16;

/// True if the port may have something for the thread.
static ASKS: AtomicBool = AtomicBool::new(false);

/// USB port.
pub(crate) struct Usb {
    device: UsbDevice<'static, UsbBus>,
    class: CdcAcmClass<'static, UsbBus>,
    /// Packet that arrived, and the part of it that nobody has taken.
    packet: [u8; PACKET],
    rest: core::ops::Range<usize>,
    waiting: Deque<u8, WAITING>,
    /// True if the last packet was full, so that the host waits for another.
    is_open: bool,
}

impl Usb {
    /// Takes the port. A board whose number is 0 has no serial number.
    pub(crate) fn new(
        registers: USBCTRL_REGS,
        memory: USBCTRL_DPRAM,
        clock: UsbClock,
        resets: &mut RESETS,
        number: u64,
    ) -> Option<Self> {
        // GP24 tells on a Pico whether the cable has power, and on a Pico W it leads to the radio chip. One firmware is
        // for both, so the cable is taken to have power.
        let bus = UsbBus::new(registers, memory, clock, true, resets);
        let bus: &'static _ = cortex_m::singleton!(: UsbBusAllocator<UsbBus> = UsbBusAllocator::new(bus))?;
        let digits: &'static _ = cortex_m::singleton!(: [u8; DIGITS] = hexadecimal(number))?;
        let strings = StringDescriptors::new(LangID::EN_US).manufacturer(MANUFACTURER).product(PRODUCT);
        let strings = match core::str::from_utf8(digits) {
            Ok(digits) if number != 0 => strings.serial_number(digits),
            _ => strings,
        };
        let class = CdcAcmClass::new(bus, PACKET as u16);
        let device =
            UsbDeviceBuilder::new(bus, ID).strings(&[strings]).ok()?.max_packet_size_0(PACKET as u8).ok()?;
        let device = device.device_class(USB_CLASS_CDC).build();
        let (packet, rest) = ([0; PACKET], 0..0);
        // SAFETY: the interrupt shares nothing but the flag.
        unsafe { NVIC::unmask(Interrupt::USBCTRL_IRQ) };
        Some(Self { device, class, packet, rest, waiting: Deque::new(), is_open: false })
    }

    /// Returns true if the port may have something for the thread.
    pub(crate) fn asks() -> bool {
        ASKS.load(Ordering::Relaxed)
    }

    /// Serves the host: its requests to the device, and packets that are complete.
    pub(crate) fn serve(&mut self) {
        ASKS.store(false, Ordering::Relaxed);
        self.device.poll(&mut [&mut self.class]);
        if self.device.state() != UsbDeviceState::Configured {
            self.waiting.clear();
            (self.rest, self.is_open) = (0..0, false);
        }
        self.write();
        // SAFETY: the interrupt shares nothing but the flag.
        unsafe { NVIC::unmask(Interrupt::USBCTRL_IRQ) };
    }

    /// Takes the next byte that arrived.
    pub(crate) fn take(&mut self) -> Option<u8> {
        if self.rest.is_empty() {
            let length = self.class.read_packet(&mut self.packet).ok()?;
            self.rest = 0..length;
        }
        let at = self.rest.next()?;
        self.packet.get(at).copied()
    }

    /// Sends bytes, or none of them if there is no room for all. A host that misses an answer asks again.
    pub(crate) fn send(&mut self, bytes: &[u8]) {
        if WAITING - self.waiting.len() >= bytes.len() {
            let _ = bytes.iter().try_for_each(|byte| self.waiting.push_back(*byte));
        }
        self.write();
    }

    /// Gives the bus the next packet, if it takes one. An empty packet ends a transfer whose last one was full.
    fn write(&mut self) {
        if self.waiting.is_empty() && !self.is_open {
            return;
        }
        let mut packet = [0; PACKET];
        let length = self.waiting.len().min(PACKET);
        packet.iter_mut().zip(&self.waiting).for_each(|(to, byte)| *to = *byte);
        let taken = self.class.write_packet(packet.get(..length).unwrap_or_default());
        if taken.is_ok() {
            for _ in 0..length {
                self.waiting.pop_front();
            }
            self.is_open = length == PACKET;
        }
    }
}

/// Returns the digits of a number.
fn hexadecimal(number: u64) -> [u8; DIGITS] {
    let digit = |at: usize| b"0123456789abcdef"[(number >> (4 * (DIGITS - 1 - at))) as usize & 0xf];
    core::array::from_fn(digit)
}

/// Wakes the thread. The interrupt stays off until the thread has served the port.
#[interrupt]
fn USBCTRL_IRQ() {
    NVIC::mask(Interrupt::USBCTRL_IRQ);
    ASKS.store(true, Ordering::Relaxed);
}
