//! A dose over the board's own USB port, and the number that the board reads from its flash chip.

use std::error::Error;
use std::path::Path;

use pump_bench::drives::{Drive, Leave, Opening};
use pump_bench::pump_file::Axis;

use crate::board::emulator::{Emulator, Extremes};
use crate::board::motor::rises;
use crate::doses::{MOST_OFF_US, distances_us, meet_at};
use crate::size::STACK;
use crate::{check, size};

/// Numbers of emulated flash chips: one of its own, and two of chips that tell none.
const NUMBER: &str = "e6605838834c17af";
const NO_NUMBERS: [&str; 2] = ["ffffffffffffffff", "0000000000000000"];

/// Most time for which the USB port may keep interrupts off, in ns. A reset of the bus, when a cable is
/// plugged in, takes longest.
const MOST_USB_OFF_NS: f64 = 30_000.0;

/// Makes a dose over USB. Holds the names of the device, the number of the board, the times of the steps and the time
/// for which the port keeps interrupts off, and the sizes of the firmware.
pub(crate) fn dose(firmware: &Path) -> Result<(), Box<dyn Error>> {
    for number in NO_NUMBERS {
        let (record, names) = met(firmware, number)?;
        check(record.contains(r#""number":null"#), "the number of a board that has none")?;
        check(names == ["1209:0001", "pump-dose", "node"], "the names of a board without a number")?;
    }
    let (record, names) = met(firmware, NUMBER)?;
    println!("USB device {}", names.join(", "));
    check(record.contains(NUMBER), "the number of the board")?;
    check(names == ["1209:0001", "pump-dose", "node", NUMBER], "the names of the USB device")?;

    let emulator = Emulator::with_options(firmware, &["--usb"])?;
    let mut met = meet_at(emulator, Axis::X, &Opening::default())?;
    let plan = met.plan(2.0, 4.0, true)?;
    met.node.check(&plan)?;
    let made = met.node.run(&plan, &mut |_, _| Leave::Go)?;
    let rises = rises(&met.emulator.take_edges(), Axis::X as u8);
    let off_us = distances_us(&plan, &rises);
    let (least, most) = off_us.iter().fold((f64::MAX, f64::MIN), |(a, b), off| (a.min(*off), b.max(*off)));
    let half_us = 0.5 * (most - least);
    let Extremes { off_ns, usb_off_ns, stack } = met.emulator.extremes()?;
    println!(
        "2 mL at 4 mL/s, smooth, over USB: {} steps, rises within {half_us:.3} us of the plan; interrupts off for \
         {:.1} us at most, for the port's sake {:.1} us",
        rises.len(),
        1e-3 * off_ns,
        1e-3 * usb_off_ns
    );
    check(made == plan.steps().unsigned_abs() && rises.len() as u64 == made, "the number of steps over USB")?;
    check(half_us <= MOST_OFF_US, "the times of the steps over USB")?;
    check(
        usb_off_ns > 0.0 && usb_off_ns <= MOST_USB_OFF_NS,
        "the time for which the USB port keeps interrupts off",
    )?;
    size::hold(firmware, STACK - stack)
}

/// Meets a board whose flash chip has this number. Returns the record of it, and the names of its USB device.
fn met(firmware: &Path, number: &str) -> Result<(String, Vec<String>), Box<dyn Error>> {
    let folder = std::env::temp_dir().join(format!("check-node-{}-{number}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    let opening = Opening { settings_record: Some(folder.join("board-settings.json")), ..Opening::default() };
    let emulator = Emulator::with_options(firmware, &["--usb", "--number", number])?;
    let names = meet_at(emulator, Axis::X, &opening).and_then(|met| Ok(met.emulator.usb_names()?));
    let record = std::fs::read_to_string(folder.join("board.json"));
    std::fs::remove_dir_all(&folder)?;
    let names = names?.into_iter().filter(|name| !name.is_empty()).collect();
    Ok((record?, names))
}
