//! Doses with the Pico's firmware in an emulator, by the drive that the command uses, in the board's own time. The
//! edges of the step and direction pins are held against the plan.
//!
//! `check-node FIRMWARE.elf` makes all parts, as many at a time as the computer has cores.
//! `check-node FIRMWARE.elf PART [NUMBER]` makes one of them: `cuts 200` cuts the link 200 times.
#![allow(clippy::print_stdout, reason = "this program prints what it measured")]

mod axes;
mod board;
mod check;
mod command;
mod cuts;
mod doses;
mod parts;
mod retarget;
mod ripple;
mod sensors;
mod size;
mod slow;
mod stops;
mod together;
mod uf2;
mod usb;

use std::error::Error;
use std::path::Path;

pub(crate) use check::check;

fn main() -> Result<(), Box<dyn Error>> {
    let mut words = std::env::args().skip(1);
    let Some(firmware) = words.next() else {
        return Err("name the firmware, an ELF file".into());
    };
    let firmware = Path::new(&firmware);
    match words.next() {
        Some(part) => parts::make(firmware, &part, words.next().as_deref()),
        None => parts::make_all(firmware),
    }
}
