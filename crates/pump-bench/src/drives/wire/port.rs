//! The serial port of a board: its lock and its bytes.

use std::io;
use std::path::Path;
use std::time::{Duration, Instant};

use serialport::SerialPort;

use super::error::PortError;
use super::port_fault::PortFault;
use super::{Wire, holder};

/// Longest wait for the system to take bytes.
const WRITE_LIMIT: Duration = Duration::from_secs(2);

/// Wait for the system to take bytes before they are offered anew.
const WRITE_WAIT: Duration = Duration::from_millis(100);

/// Longest pause of this program that counts as time of the board. A pause comes from a slow disk, or from a
/// process that was stopped for a while.
const LONGEST_PAUSE: Duration = Duration::from_millis(500);

/// Serial port that no other process has.
#[derive(Debug)]
pub(in crate::drives) struct BoardPort {
    /// Holds the lock and the settings of the line.
    serial: Box<dyn SerialPort>,
    /// Reads and writes the bytes.
    line: SerialHandle,
    /// Time on the clock, and the instant at which it was read.
    clock: (Duration, Instant),
    opened: Instant,
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
        let opened = Instant::now();
        Ok(Self { serial, line, clock: (Duration::ZERO, opened), opened })
    }
}

impl Wire for BoardPort {
    fn read(&mut self, buffer: &mut [u8], wait: Duration) -> io::Result<usize> {
        match self.line.read(&mut self.serial, buffer, wait) {
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
        let mut rest = bytes;
        while !rest.is_empty() {
            match self.line.write(&mut self.serial, rest) {
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

    fn steady_now(&mut self) -> Duration {
        self.opened.elapsed()
    }

    fn steady_begin(&self) -> Option<Instant> {
        Some(self.opened)
    }

    fn sleep(&mut self, time: Duration) {
        std::thread::sleep(time);
    }
}

/// Handle of the device, beside the serial port made of it. It never waits for more than it was told: another program
/// that opened the port first may take the bytes that the system has just announced, and a read of the serial port
/// itself would then wait for the next ones, however long.
#[cfg(unix)]
#[derive(Debug)]
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

    /// Reads what is there, and waits until `wait` has passed for the first byte.
    fn read(&self, _: &mut Box<dyn SerialPort>, buffer: &mut [u8], wait: Duration) -> io::Result<usize> {
        self.wait_for(rustix::event::PollFlags::IN, wait)?;
        self.take(buffer)
    }

    /// Reads what is there now. Fails as a read that would block if nothing is there.
    fn take(&self, buffer: &mut [u8]) -> io::Result<usize> {
        Ok(rustix::io::read(&self.0, buffer)?)
    }

    fn write(&self, _: &mut Box<dyn SerialPort>, bytes: &[u8]) -> io::Result<usize> {
        self.wait_for(rustix::event::PollFlags::OUT, WRITE_WAIT)?;
        Ok(rustix::io::write(&self.0, bytes)?)
    }

    /// Waits until the device is ready. Fails as a pipe that broke if the device has gone.
    fn wait_for(&self, ready: rustix::event::PollFlags, wait: Duration) -> io::Result<()> {
        use rustix::event::{PollFd, PollFlags, Timespec, poll};

        let mut asked = [PollFd::new(&self.0, ready)];
        if poll(&mut asked, Timespec::try_from(wait).ok().as_ref())? == 0 {
            return Err(io::ErrorKind::TimedOut.into());
        }
        if asked[0].revents().intersects(PollFlags::HUP | PollFlags::NVAL) {
            return Err(io::ErrorKind::BrokenPipe.into());
        }
        Ok(())
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
#[derive(Debug)]
struct SerialHandle;

#[cfg(not(unix))]
impl SerialHandle {
    fn open(_path: &Path) -> io::Result<Self> {
        Ok(Self)
    }

    fn is_serial(&self) -> Result<(), PortFault> {
        Ok(())
    }

    fn read(&self, serial: &mut Box<dyn SerialPort>, buffer: &mut [u8], wait: Duration) -> io::Result<usize> {
        serial.set_timeout(wait)?;
        serial.read(buffer)
    }

    fn write(&self, serial: &mut Box<dyn SerialPort>, bytes: &[u8]) -> io::Result<usize> {
        serial.set_timeout(WRITE_WAIT)?;
        serial.write(bytes)
    }

    fn stays_awake(&self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
#[cfg(unix)]
mod tests {
    use std::path::PathBuf;

    use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};

    use super::*;

    /// A board's end of a line, and the computer's end.
    fn terminal() -> (std::os::fd::OwnedFd, PathBuf) {
        let board = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC).unwrap();
        grantpt(&board).unwrap();
        unlockpt(&board).unwrap();
        let name = ptsname(&board, Vec::new()).unwrap();
        (board, PathBuf::from(name.into_string().unwrap()))
    }

    #[test]
    fn bytes_that_an_earlier_opener_took_are_waited_for_by_nobody() {
        let (board, path) = terminal();
        let other = SerialHandle::open(&path).unwrap();
        let mut port = BoardPort::open(Some(&path), 115_200).unwrap();
        assert_eq!(rustix::io::write(&board, b"ok").unwrap(), 2);
        port.line.wait_for(rustix::event::PollFlags::IN, Duration::from_secs(5)).unwrap();
        let mut taken = [0; 8];
        assert_eq!(other.take(&mut taken).unwrap(), 2);
        // The system has announced bytes that are not there any more.
        assert_eq!(port.line.take(&mut taken).unwrap_err().kind(), io::ErrorKind::WouldBlock);
        assert_eq!(port.read(&mut taken, Duration::from_millis(1)).unwrap(), 0);
        // A board that is read by nobody else is heard.
        rustix::io::write(&board, b"ok\n").unwrap();
        assert_eq!(port.read(&mut taken, Duration::from_secs(5)).unwrap(), 3);
        port.write(b"?").unwrap();
        assert_eq!(rustix::io::read(&board, &mut taken).unwrap(), 1);
    }

    #[test]
    fn a_line_that_takes_no_bytes_is_an_error_after_two_seconds() {
        let (_board, path) = terminal();
        let mut port = BoardPort::open(Some(&path), 115_200).unwrap();
        let began = Instant::now();
        let error = port.write(&[b'?'; 1 << 20]).unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::TimedOut);
        assert!(began.elapsed() >= WRITE_LIMIT, "{:?}", began.elapsed());
    }
}
