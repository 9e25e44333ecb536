//! Ports that cannot be opened.

use std::path::PathBuf;

use super::port_fault::PortFault;

/// Reason for which a port was not opened. Each drive words it as its own error.
#[derive(Debug)]
pub(in crate::drives) enum PortError {
    /// No port is named.
    Unnamed,
    /// Another process has the port.
    Busy {
        /// Path of the port.
        device: PathBuf,
        /// Holder of the port, as far as the system tells.
        holder: String,
    },
    /// The system does not open the port.
    Open {
        /// Path of the port.
        port: PathBuf,
        /// Fault of the port.
        fault: PortFault,
    },
}
