//! The serial ports at which boards appear.

use std::path::{Path, PathBuf};

/// Returns the serial ports below `dev` (`/dev`) at which boards on a USB cable appear: those of `serial/by-id`, whose
/// names stay, then `ttyUSB*`, `ttyACM*` and `cu.usb*` that have no such name.
pub fn serial_ports(dev: &Path) -> Vec<PathBuf> {
    let listed = |folder: PathBuf| {
        let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
        let mut paths: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
        paths.sort();
        paths
    };
    let is_usb = |path: &PathBuf| {
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        ["ttyUSB", "ttyACM", "cu.usb"].iter().any(|start| name.starts_with(start))
    };
    let named = listed(dev.join("serial").join("by-id"));
    let devices: Vec<_> = named.iter().filter_map(|path| path.canonicalize().ok()).collect();
    let others = listed(dev.to_owned()).into_iter().filter(is_usb);
    let others = others.filter(|path| path.canonicalize().is_ok_and(|device| !devices.contains(&device)));
    named.into_iter().chain(others).collect()
}
