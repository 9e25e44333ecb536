//! The ports of a node: one of them has the session.

use pump_link::frame::Deframer;

/// Number of ports of a node.
pub const PORTS: usize = 2;

/// The ports of a node. Each finds frames of its own, so that bytes of one do not run into those of another.
///
/// A session belongs to the port over which it was adopted. Requests that change something are taken from that port
/// alone. Requests that only ask are answered on any port, and do not feed the dead-man timer.
#[derive(Debug)]
pub(crate) struct Ports {
    deframers: [Deframer; PORTS],
    /// Port that has the session. It means nothing before a session was adopted.
    home: usize,
}

impl Ports {
    pub(crate) const fn new() -> Self {
        Self { deframers: [const { Deframer::new() }; PORTS], home: 0 }
    }

    /// Returns the machine that finds the frames of a port, or `None` if there is no such port.
    pub(crate) fn deframer(&mut self, port: usize) -> Option<&mut Deframer> {
        self.deframers.get_mut(port)
    }

    /// Returns true if the session belongs to this port.
    pub(crate) fn is_home(&self, port: usize) -> bool {
        self.home == port
    }

    /// Gives the session to a port.
    pub(crate) fn move_to(&mut self, port: usize) {
        self.home = port;
    }
}
