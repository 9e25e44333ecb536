//! A dose over the board's own USB port, and the number that the board reads from its flash chip.

use std::error::Error;
use std::path::Path;

use pump_bench::drives::{Drive, Leave, Opening};
use pump_bench::pump_file::Axis;

use crate::emulator::Emulator;
use crate::size::STACK;
use crate::{MOST_OFF_US, Met, check, distances_us, meet_at, rises};

/// Numbers of emulated boards, and that of a chip that tells none.
const NUMBER: &str = "e6605838834c17af";
const NO_NUMBER: &str = "ffffffffffffffff";

/// Most time for which interrupts are off, in ns: the take of a frame by the UART alone needs 12.7 us.
const MOST_OFF_NS: f64 = 12_700.0;

/// Makes a dose over USB, and holds the names of the device, the number of the board, the times of the steps and the
/// time for which interrupts are off. Returns the bytes of stack that were used.
pub(crate) fn dose(firmware: &Path) -> Result<u32, Box<dyn Error>> {
    let folder = std::env::temp_dir().join(format!("check-node-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    let record = folder.join("board-settings.json");
    let emulator = Emulator::with_options(firmware, &["--usb", "--number", NUMBER])?;
    let met = meet_at(emulator, Axis::X, &Opening { settings_record: Some(record.clone()), ..Opening::default() });
    let recorded = std::fs::read_to_string(&record);
    std::fs::remove_dir_all(&folder)?;
    let Met { emulator, mut node, .. } = &mut met?;
    check(recorded?.contains(NUMBER), "the number of the board")?;
    let names = emulator.usb_names()?;
    println!("USB device {}", names.join(", "));
    check(names == ["1209:0001", "pump-dose", "node", NUMBER], "the names of the USB device")?;
    todo!()
}
