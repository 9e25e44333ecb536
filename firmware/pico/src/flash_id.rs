//! The number of the board: the unique number of its flash chip.
//!
//! The chip answers commands only while no code is read from it. So a routine in RAM ends the execution in place (XIP),
//! asks, and runs a copy of the second boot stage, which sets up the execution in place as it was. The boot ROM's
//! routines for this are not called (`disable-intrinsics`); this is their sequence (RP2040 datasheet, sections 2.8.1.2
//! and 2.8.3.1.3; pico-bootrom, program_flash_generic.c).
#![allow(unsafe_code)]

use core::mem;
use core::ptr;

use crate::boot::BOOT2_FIRMWARE;

/// Registers of the serial interface of the flash chip (RP2040 datasheet, section 4.10.13).
const SSI: usize = 0x1800_0000;
const CTRLR0: usize = SSI;
const SSIENR: usize = SSI + 0x08;
const SER: usize = SSI + 0x10;
const BAUDR: usize = SSI + 0x14;
const SR: usize = SSI + 0x28;
const ICR: usize = SSI + 0x48;
const DR0: usize = SSI + 0x60;

/// CTRLR0 for bytes on one line each way: frames of 8 bits, standard SPI, transmit and receive.
const SERIAL_BYTES: u32 = 7 << 16;

/// Bit of SR that says that a byte was received.
const RECEIVED: u32 = 1 << 3;

/// Divisor of the clock that the boot ROM takes for commands.
const DIVISOR: u32 = 6;

/// Control of the chip's select pin (RP2040 datasheet, section 2.19.6.2), and what its output is forced to.
const SELECT: usize = 0x4001_8000 + 0x0c;
const FORCED: u32 = 3 << 8;
const FORCED_LOW: u32 = 2 << 8;
const FORCED_HIGH: u32 = 3 << 8;

/// Controls of the data pins' pads (RP2040 datasheet, section 2.19.6.4): four registers from this one on.
const DATA_PADS: usize = 0x4002_0000 + 0x08;
const OUTPUT_OFF: u32 = 1 << 7;
const PULL_UP: u32 = 1 << 3;
const PULL_DOWN: u32 = 1 << 2;

/// Command that reads the unique number, and the number of bytes before it (W25Q16JV datasheet, "Read Unique ID
/// Number").
const READ_UNIQUE_ID: u8 = 0x4b;
const DUMMY_BYTES: usize = 4;

/// Bytes of the number.
const BYTES: usize = 8;

/// Turns for which the pulls of the pads take effect, some 6,000 cycles.
const PULL_TURNS: u32 = 1 << 11;

/// Turns after which a byte that was not received never will be.
const MOST_TURNS: u32 = 100_000;

/// Returns the number of the board. It is 0 if the chip tells none: all ones or all zeros.
///
/// Call it once, before any other code of the board runs: interrupts, the second core and the DMA do not read the flash
/// meanwhile.
pub(crate) fn read() -> u64 {
    let mut boot2 = [0_u32; BOOT2_FIRMWARE.len() / 4];
    let from: *const u32 = (&raw const BOOT2_FIRMWARE).cast();
    for (at, word) in boot2.iter_mut().enumerate() {
        // SAFETY: the boot stage has so many words, and lies at the start of the flash.
        *word = unsafe { ptr::read_volatile(from.add(at)) };
    }
    let mut id = [0; BYTES];
    cortex_m::interrupt::free(|_| {
        // The lowest bit says that the code is Thumb.
        let start = boot2.as_ptr() as usize | 1;
        // SAFETY: the boot stage runs anywhere, and returns to a caller (exit_from_boot2.S of the Pico SDK). The flash
        // is read by nobody else, as the caller promises.
        unsafe { ask(mem::transmute::<usize, extern "C" fn()>(start), &mut id) };
    });
    match u64::from_be_bytes(id) {
        u64::MAX => 0,
        number => number,
    }
}

/// Asks the chip for its number. `enter_xip` sets up the execution in place, and lies in RAM as this function does.
///
/// No call leads to the flash in between: everything is inlined.
#[inline(never)]
#[unsafe(link_section = ".data.flash_id")]
unsafe fn ask(enter_xip: extern "C" fn(), id: &mut [u8; BYTES]) {
    // Bytes on one line each way, at the boot ROM's clock.
    put(SSIENR, 0);
    get(SR);
    get(ICR);
    put(BAUDR, DIVISOR);
    put(CTRLR0, SERIAL_BYTES);
    put(SER, 1);
    put(SSIENR, 1);

    // A chip that waits for an address takes this for one whose mode bits end that: 32 clocks unselected with data low,
    // 32 clocks selected with data high, then 16 clocks selected with ones on the first line.
    let pad = get(DATA_PADS);
    let floating = (pad & !(PULL_UP | PULL_DOWN)) | OUTPUT_OFF;
    select(FORCED_HIGH);
    put_pads(floating | PULL_DOWN);
    wait();
    exchange_zeros();
    put_pads(floating | PULL_UP);
    select(FORCED_LOW);
    wait();
    exchange_zeros();
    select(FORCED_HIGH);
    put_pads(pad);
    select(FORCED_LOW);
    exchange(0xff);
    exchange(0xff);
    select(FORCED_HIGH);

    select(FORCED_LOW);
    exchange(READ_UNIQUE_ID);
    let mut at = 0;
    while at < DUMMY_BYTES {
        exchange(0);
        at += 1;
    }
    for byte in id {
        *byte = exchange(0);
    }
    select(FORCED_HIGH);

    // The interface drives the pin again.
    select(0);
    enter_xip();
}

#[inline(always)]
fn put(register: usize, word: u32) {
    // SAFETY: the constants above are registers of the chip.
    unsafe { ptr::write_volatile(register as *mut u32, word) }
}

#[inline(always)]
fn get(register: usize) -> u32 {
    // SAFETY: the constants above are registers of the chip.
    unsafe { ptr::read_volatile(register as *const u32) }
}

/// Forces the select pin, or has the interface drive it.
#[inline(always)]
fn select(forced: u32) {
    put(SELECT, (get(SELECT) & !FORCED) | forced);
    // A read waits until the pin's control has the word.
    get(SELECT);
}

#[inline(always)]
fn put_pads(word: u32) {
    put(DATA_PADS, word);
    put(DATA_PADS + 4, word);
    put(DATA_PADS + 8, word);
    put(DATA_PADS + 12, word);
}

#[inline(always)]
fn wait() {
    let mut turns = PULL_TURNS;
    while turns > 0 {
        // The read keeps the loop.
        get(SR);
        turns -= 1;
    }
}

/// Sends a byte, and returns the one that came meanwhile. It is all ones if none came.
#[inline(always)]
fn exchange(byte: u8) -> u8 {
    put(DR0, byte.into());
    let mut turns = MOST_TURNS;
    while get(SR) & RECEIVED == 0 {
        turns -= 1;
        if turns == 0 {
            return 0xff;
        }
    }
    get(DR0) as u8
}

#[inline(always)]
fn exchange_zeros() {
    exchange(0);
    exchange(0);
    exchange(0);
    exchange(0);
}
