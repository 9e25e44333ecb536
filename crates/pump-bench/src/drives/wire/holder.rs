//! The process that holds a device.

use std::io;
use std::path::Path;

/// Returns true if a serial port was not opened because a process holds it.
pub(super) fn has_it(error: &serialport::Error, path: &Path) -> bool {
    match error.kind() {
        // serialport reports both a locked or busy device and a missing one as `NoDevice`.
        serialport::ErrorKind::NoDevice => lock_holder(path).is_some() || error.description.contains("lock"),
        serialport::ErrorKind::Io(kind) => cfg!(windows) && kind == io::ErrorKind::PermissionDenied,
        _ => false,
    }
}

/// Names the holder of a device, as far as the system tells.
pub(super) fn of(path: &Path) -> String {
    lock_holder(path).unwrap_or_else(|| "another process".to_owned())
}

/// Names the process that has a lock on the file, as Linux lists it. Device and inode are the sixth column of
/// /proc/locks.
#[cfg(unix)]
fn lock_holder(path: &Path) -> Option<String> {
    let stat = rustix::fs::stat(path).ok()?;
    let (major, minor) = (rustix::fs::major(stat.st_dev), rustix::fs::minor(stat.st_dev));
    let file = format!("{major:02x}:{minor:02x}:{}", stat.st_ino);
    let locks = std::fs::read_to_string("/proc/locks").ok()?;
    locks.lines().find_map(|lock| {
        let columns: Vec<_> = lock.split_whitespace().collect();
        let [_, _, _, _, process, locked, ..] = columns.as_slice() else { return None };
        (*locked == file).then(|| {
            let name = std::fs::read_to_string(format!("/proc/{process}/comm")).unwrap_or_default();
            format!("process {process} ({})", name.trim())
        })
    })
}

#[cfg(not(unix))]
fn lock_holder(_path: &Path) -> Option<String> {
    None
}
