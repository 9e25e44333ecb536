//! The wire to a board: its bytes, and the clock of every wait for them.

mod ask_clock;
mod error;
mod holder;
mod open_ports;
mod port;
mod port_fault;
mod port_name;
mod serial_ports;

use std::fmt::Debug;
use std::io;
use std::time::{Duration, Instant};

pub use ask_clock::AskClock;
pub(super) use ask_clock::SystemAskClock;
pub(super) use error::PortError;
pub(super) use open_ports::{NotShared, OpenPorts};
pub(super) use port::BoardPort;
pub use port_fault::PortFault;
pub(crate) use port_name::port_name;
pub use serial_ports::serial_ports;

/// Wire to a board.
pub trait Wire: Debug + Send {
    /// Reads the bytes that have come, and waits until `wait` has passed for the first. Returns 0 if none
    /// came.
    ///
    /// # Errors
    ///
    /// [`io::Error`] if the board is out of reach.
    fn read(&mut self, buffer: &mut [u8], wait: Duration) -> io::Result<usize>;

    /// Writes all of `bytes`.
    ///
    /// # Errors
    ///
    /// [`io::Error`] if the board is out of reach.
    fn write(&mut self, bytes: &[u8]) -> io::Result<()>;

    /// Returns the time since the wire was opened.
    ///
    /// A pause of this program between two calls counts little: what the board said meanwhile is not read
    /// yet, so the pause does not tell that the board is late.
    fn now(&mut self) -> Duration;

    /// Returns the time since the wire was opened by a clock that no pause holds up, for a device whose clock is
    /// followed. A wire in virtual time has one clock for both.
    fn steady_now(&mut self) -> Duration {
        self.now()
    }

    /// Returns the begin of the steady clock, by which the times of several wires are compared. `None` in virtual time.
    fn steady_begin(&self) -> Option<Instant> {
        None
    }

    /// Lets `time` pass.
    fn sleep(&mut self, time: Duration);

    /// Returns true for a board in virtual time that must stand while any thread that streams to it works.
    fn stands_while_hosts_work(&self) -> bool {
        false
    }

    /// Returns the clock of a thread that asks for leave while another one has the wire.
    fn ask_clock(&mut self) -> Box<dyn AskClock> {
        Box::new(SystemAskClock::default())
    }
}
