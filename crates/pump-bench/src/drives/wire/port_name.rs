//! The name that a serial port keeps.

use std::path::Path;

/// Returns the name of the entry in `folder` that leads to the device at `port`. There is none if no entry does, as for
/// ports that are no USB adapters.
///
/// Linux keeps such names in /dev/serial/by-id (systemd, 60-serial.rules). They are made of what the adapter says of
/// itself, so a port keeps its name when ttyUSB0 and ttyUSB1 change places.
pub(crate) fn port_name(port: &Path, folder: &Path) -> Option<String> {
    let device = port.canonicalize().ok()?;
    let entries = std::fs::read_dir(folder).ok()?.flatten();
    let same = entries.filter(|entry| entry.path().canonicalize().is_ok_and(|path| path == device));
    same.map(|entry| entry.file_name().to_string_lossy().into_owned()).min()
}
