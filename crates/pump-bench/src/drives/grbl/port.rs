//! The serial port of a board: its lock and its bytes.

use std::io::{self, Read, Write};
use std::path::Path;
use std::time::{Duration, Instant};

use serialport::SerialPort;

use super::error::GrblError;
use super::holder;
use crate::drives::DriveError;
use crate::pump_file::DriveTable;

/// Longest wait for the system to take bytes.
const WRITE_LIMIT: Duration = Duration::from_secs(2);

/// Serial port that no other process has.
#[derive(Debug)]
pub(super) struct Port {
    serial: Box<dyn SerialPort>,
}

impl Port {
    /// Opens the port of `table` for this process alone.
    pub(super) fn open(table: &DriveTable) -> Result<Self, DriveError> {
        let path = table.port.as_deref().ok_or(GrblError::NoPort)?;
        let fails = |reason: String| GrblError::Open { port: path.to_owned(), reason };
        let busy = || DriveError::Busy { device: path.to_owned(), holder: holder::of(path) };
        // This handle is opened first: once serialport has the device, no other open succeeds.
        let line = match Line::open(path) {
            Ok(line) => line,
            Err(error) if error.kind() == io::ErrorKind::ResourceBusy => return Err(busy()),
            Err(error) => return Err(fails(error.to_string()).into()),
        };
        // serialport takes a lock of the system (flock) and forbids further opens (TIOCEXCL).
        let builder = serialport::new(path.to_string_lossy(), table.baud).timeout(Duration::from_millis(1));
        let serial = match builder.open() {
            Ok(serial) => serial,
            Err(error) if holder::has_it(&error, path) => return Err(busy()),
            Err(error) => return Err(fails(error.to_string()).into()),
        };
        line.stays_awake().map_err(|error| fails(error.to_string()))?;
        serial.clear(serialport::ClearBuffer::Input).map_err(|error| fails(error.to_string()))?;
        Ok(Self { serial })
    }

    /// Reads the bytes that have come, and waits until `wait` has passed for the first. Returns 0 if none
    /// came.
    pub(super) fn read(&mut self, buffer: &mut [u8], wait: Duration) -> Result<usize, GrblError> {
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
    pub(super) fn write(&mut self, bytes: &[u8]) -> Result<(), GrblError> {
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

/// Handle of the device, beside the serial port made of it.
#[cfg(unix)]
struct Line(std::os::fd::OwnedFd);

#[cfg(unix)]
impl Line {
    fn open(path: &Path) -> io::Result<Self> {
        use rustix::fs::{Mode, OFlags};

        let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::NONBLOCK | OFlags::CLOEXEC;
        Ok(Self(rustix::fs::open(path, flags, Mode::empty())?))
    }

    /// Keeps the line that resets Arduinos (DTR) from falling when the port is closed, so that the next open
    /// does not reset the board. The first open since the computer started may reset it all the same.
    fn stays_awake(&self) -> io::Result<()> {
        use rustix::termios::{ControlModes, OptionalActions, tcgetattr, tcsetattr};

        let mut modes = tcgetattr(&self.0)?;
        modes.control_modes.remove(ControlModes::HUPCL);
        Ok(tcsetattr(&self.0, OptionalActions::Now, &modes)?)
    }
}

/// Handle on systems where only serialport opens the device.
#[cfg(not(unix))]
struct Line;

#[cfg(not(unix))]
impl Line {
    fn open(_path: &Path) -> io::Result<Self> {
        Ok(Self)
    }

    fn stays_awake(&self) -> io::Result<()> {
        Ok(())
    }
}
