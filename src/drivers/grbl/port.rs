//! The serial port: whose it is, its bytes.

use std::io::{self, Read, Write};
use std::path::Path;
use std::time::{Duration, Instant};

use serialport::SerialPort;

use super::error::GrblError;
use crate::drivers::DriveError;
use crate::pump_file::DriveTable;

/// Longest wait for the system to take bytes.
const WRITE_LIMIT: Duration = Duration::from_secs(2);

/// A serial port that no other process has.
#[derive(Debug)]
pub(super) struct Port {
    serial: Box<dyn SerialPort>,
}

impl Port {
    /// Opens the port of `table` for this process alone.
    pub fn open(table: &DriveTable) -> Result<Self, DriveError> {
        let path = table.port.as_deref().ok_or(GrblError::NoPort)?;
        let fails = |reason: String| GrblError::Open { port: path.to_owned(), reason };
        // serialport takes a lock of the system (flock) and forbids further opens (TIOCEXCL).
        let builder = serialport::new(path.to_string_lossy(), table.baud).timeout(Duration::from_millis(1));
        let serial = builder.open().map_err(|error| match holder(path, &error) {
            Some(holder) => DriveError::Busy { device: path.to_owned(), holder },
            None => fails(error.to_string()).into(),
        })?;
        stay_awake(path).map_err(|error| fails(error.to_string()))?;
        serial.clear(serialport::ClearBuffer::Input).map_err(|error| fails(error.to_string()))?;
        Ok(Self { serial })
    }

    /// Reads what has come, waiting for it until `wait` has passed. 0 if nothing has.
    pub fn read(&mut self, buffer: &mut [u8], wait: Duration) -> Result<usize, GrblError> {
        let failed = |error: serialport::Error| GrblError::Gone(error.into());
        self.serial.set_timeout(wait).map_err(failed)?;
        match self.serial.read(buffer) {
            Ok(0) => Err(GrblError::Gone(io::ErrorKind::UnexpectedEof.into())),
            Ok(count) => Ok(count),
            Err(error) => match error.kind() {
                io::ErrorKind::TimedOut | io::ErrorKind::Interrupted | io::ErrorKind::WouldBlock => Ok(0),
                _ => Err(GrblError::Gone(error)),
            },
        }
    }

    /// Writes all of `bytes`.
    pub fn write(&mut self, bytes: &[u8]) -> Result<(), GrblError> {
        let until = Instant::now() + WRITE_LIMIT;
        self.serial.set_timeout(Duration::from_millis(100)).map_err(|error| GrblError::Gone(error.into()))?;
        let mut rest = bytes;
        while !rest.is_empty() {
            match self.serial.write(rest) {
                Ok(count) => rest = rest.get(count..).unwrap_or_default(),
                Err(error) => match error.kind() {
                    io::ErrorKind::TimedOut | io::ErrorKind::Interrupted | io::ErrorKind::WouldBlock
                        if Instant::now() < until => {}
                    _ => return Err(GrblError::Gone(error)),
                },
            }
        }
        Ok(())
    }
}

/// Who has the port, if it could not be opened because somebody has it.
#[cfg(unix)]
fn holder(path: &Path, error: &serialport::Error) -> Option<String> {
    use rustix::io::Errno;

    // serialport says of a locked port that there is no device.
    let locked = error.kind() == serialport::ErrorKind::NoDevice && path.exists();
    let busy = Errno::from_io_error(&io::Error::from(error.clone())) == Some(Errno::BUSY)
        || error.kind() == serialport::ErrorKind::Io(io::ErrorKind::ResourceBusy);
    (locked || busy).then(|| lock_holder(path).unwrap_or_else(|| "another process".to_owned()))
}

#[cfg(not(unix))]
fn holder(_path: &Path, error: &serialport::Error) -> Option<String> {
    let denied = error.kind() == serialport::ErrorKind::Io(io::ErrorKind::PermissionDenied);
    denied.then(|| "another process".to_owned())
}

/// The process that has a lock on the file, as Linux lists it: device and inode are the sixth column of /proc/locks.
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

/// Keeps the line that resets Arduinos (DTR) from falling when the port is closed, so that the next open does not reset
/// the board. The first one since the computer was started may all the same.
#[cfg(unix)]
fn stay_awake(path: &Path) -> io::Result<()> {
    use rustix::fs::{Mode, OFlags};
    use rustix::termios::{ControlModes, OptionalActions};

    // Of the port that is open already: what is set on one is set on both.
    let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::NONBLOCK | OFlags::CLOEXEC;
    let file = rustix::fs::open(path, flags, Mode::empty())?;
    let mut modes = rustix::termios::tcgetattr(&file)?;
    modes.control_modes.remove(ControlModes::HUPCL);
    Ok(rustix::termios::tcsetattr(&file, OptionalActions::Now, &modes)?)
}

#[cfg(not(unix))]
fn stay_awake(_path: &Path) -> io::Result<()> {
    Ok(())
}
