//! The board's end of a pseudo-terminal.

use std::io;
use std::os::fd::OwnedFd;
use std::path::PathBuf;
use std::time::Duration;

use rustix::event::{PollFd, PollFlags, Timespec};
use rustix::fs::{Mode, OFlags};
use rustix::pty::OpenptFlags;

/// Board's end of a pseudo-terminal.
#[derive(Debug)]
pub(super) struct Line {
    master: OwnedFd,
    /// Other end, which is held open so that a host may close it and come again.
    _kept: OwnedFd,
}

impl Line {
    /// Opens a pseudo-terminal. Returns the board's end, and the path of the other.
    pub(super) fn new() -> io::Result<(Self, PathBuf)> {
        let master = rustix::pty::openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC)?;
        rustix::pty::grantpt(&master)?;
        rustix::pty::unlockpt(&master)?;
        let name = rustix::pty::ptsname(&master, Vec::new())?;
        let path = PathBuf::from(name.to_string_lossy().into_owned());
        rustix::fs::fcntl_setfl(&master, OFlags::RDWR | OFlags::NONBLOCK)?;
        let kept = rustix::fs::open(&path, OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC, Mode::empty())?;
        let mut modes = rustix::termios::tcgetattr(&kept)?;
        modes.make_raw();
        rustix::termios::tcsetattr(&kept, rustix::termios::OptionalActions::Now, &modes)?;
        Ok((Self { master, _kept: kept }, path))
    }

    /// Waits for bytes for as long as `longest`.
    #[allow(dead_code, reason = "a board whose time is the emulator's does not wait")]
    pub(super) fn wait(&self, longest: Duration) {
        let longest = Timespec { tv_sec: 0, tv_nsec: longest.subsec_nanos().into() };
        let _ = rustix::event::poll(&mut [PollFd::new(&self.master, PollFlags::IN)], Some(&longest));
    }

    /// Returns the bytes that have come.
    pub(super) fn read(&mut self) -> Vec<u8> {
        let mut bytes = [0; 4096];
        let count = rustix::io::read(&self.master, &mut bytes).unwrap_or(0);
        bytes.iter().take(count).copied().collect()
    }

    /// Sends bytes. Those for which the system has no room are lost, as on a wire.
    pub(super) fn write(&mut self, bytes: &[u8]) {
        let _ = rustix::io::write(&self.master, bytes);
    }
}
