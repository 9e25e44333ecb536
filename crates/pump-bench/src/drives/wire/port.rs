//! The serial port of a board: its lock and its bytes.

use std::io::{self, Read, Write};
use std::path::Path;
use std::time::{Duration, Instant};

use serialport::SerialPort;

use super::error::PortError;
use super::port_fault::PortFault;
use super::{Wire, holder};

/// Longest wait for the system to take bytes.
const WRITE_LIMIT: Duration = Duration::from_secs(2);

/// Longest pause of this program that counts as time of the board. A pause comes from a slow disk, or from a
/// process that was stopped for a while.
const LONGEST_PAUSE: Duration = Duration::from_millis(500);

/// Serial port that no other process has.
#[derive(Debug)]
pub(in crate::drives) struct BoardPort {
    serial: Box<dyn SerialPort>,
    /// Time on the clock, and the instant at which it was read.
    clock: (Duration, Instant),
}

impl BoardPort {
    /// Opens the port at `path` for this process alone, at a rate in bits per second.
    pub(in crate::drives) fn open(path: Option<&Path>, baud: u32) -> Result<Self, PortError> {
        let path = path.ok_or(PortError::Unnamed)?;
        let unfit = |fault: PortFault| PortError::Open { port: path.to_owned(), fault };
        let fails = |reason: String| unfit(PortFault::System(reason));
        let busy = || PortError::Busy { device: path.to_owned(), holder: holder::of(path) };
        // This handle is opened first: once serialport has the device, no other open succeeds.
        let line = match SerialHandle::open(path) {
            Ok(line) => line,
            Err(error) if error.kind() == io::ErrorKind::ResourceBusy => return Err(busy()),
            Err(error) => return Err(unfit(PortFault::of_file(&error))),
        };
        line.is_serial().map_err(unfit)?;
        // serialport takes a lock of the system (flock) and forbids further opens (TIOCEXCL).
        let builder = serialport::new(path.to_string_lossy(), baud).timeout(Duration::from_millis(1));
        let serial = match builder.open() {
            Ok(serial) => serial,
            Err(error) if holder::has_it(&error, path) => return Err(busy()),
            Err(error) => return Err(fails(error.to_string())),
        };
        line.stays_awake().map_err(|error| fails(error.to_string()))?;
        serial.clear(serialport::ClearBuffer::Input).map_err(|error| fails(error.to_string()))?;
        Ok(Self { serial, clock: (Duration::ZERO, Instant::now()) })
    }
}

impl Wire for BoardPort {
    fn read(&mut self, buffer: &mut [u8], wait: Duration) -> io::Result<usize> {
        self.serial.set_timeout(wait)?;
        match self.serial.read(buffer) {
            Ok(0) => Err(io::ErrorKind::UnexpectedEof.into()),
            Ok(count) => Ok(count),
            Err(error) => match error.kind() {
                io::ErrorKind::TimedOut | io::ErrorKind::Interrupted | io::ErrorKind::WouldBlock => Ok(0),
                _ => Err(error),
            },
        }
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        let until = Instant::now() + WRITE_LIMIT;
        self.serial.set_timeout(Duration::from_millis(100))?;
        let mut rest = bytes;
        while !rest.is_empty() {
            match self.serial.write(rest) {
                Ok(count) => rest = rest.get(count..).unwrap_or_default(),
                Err(error) => match error.kind() {
                    io::ErrorKind::TimedOut | io::ErrorKind::Interrupted | io::ErrorKind::WouldBlock
                        if Instant::now() < until => {}
                    _ => return Err(error),
                },
            }
        }
        Ok(())
    }

    fn now(&mut self) -> Duration {
        let (time, read) = self.clock;
        let now = Instant::now();
        self.clock = (time + (now - read).min(LONGEST_PAUSE), now);
        self.clock.0
    }

    fn sleep(&mut self, time: Duration) {
        std::thread::sleep(time);
    }
}

/// Handle of the device, beside the serial port made of it.
#[cfg(unix)]
struct SerialHandle(std::os::fd::OwnedFd);

#[cfg(unix)]
impl SerialHandle {
    fn open(path: &Path) -> io::Result<Self> {
        use rustix::fs::{Mode, OFlags};

        let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::NONBLOCK | OFlags::CLOEXEC;
        Ok(Self(rustix::fs::open(path, flags, Mode::empty())?))
    }

    /// Refuses a file that the system has no serial line for.
    fn is_serial(&self) -> Result<(), PortFault> {
        match rustix::termios::tcgetattr(&self.0) {
            Err(rustix::io::Errno::NOTTY | rustix::io::Errno::INVAL) => Err(PortFault::no_serial_line()),
            // Any other failure is told by what follows.
            _ => Ok(()),
        }
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
struct SerialHandle;

#[cfg(not(unix))]
impl SerialHandle {
    fn open(_path: &Path) -> io::Result<Self> {
        Ok(Self)
    }

    fn is_serial(&self) -> Result<(), PortFault> {
        Ok(())
    }

    fn stays_awake(&self) -> io::Result<()> {
        Ok(())
    }
}
