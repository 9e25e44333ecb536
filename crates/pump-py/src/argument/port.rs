//! The port of a line.

use pump_model::Port;
use pyo3::prelude::*;

use super::choice::choice;

/// Ports by their names.
pub(crate) const PORTS: [(&str, Port); 2] = [("inlet", Port::Inlet), ("outlet", Port::Outlet)];

/// Reads the name of a port.
pub(crate) fn port_named(port: &str) -> PyResult<Port> {
    choice("port", port, &PORTS)
}
