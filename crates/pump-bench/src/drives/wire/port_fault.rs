//! The fault of a port that cannot be opened, in words, with the ports that can.

use std::fmt::{self, Display, Formatter};
use std::io::{Error, ErrorKind};
use std::path::{Path, PathBuf};

use super::serial_ports::serial_ports;

/// Folder of the devices.
const DEVICES: &str = "/dev";

/// Most ports that a message names.
const MOST_NAMED: usize = 3;

/// Fault of a port that cannot be opened as a serial port.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum PortFault {
    /// No file has the name of the port.
    Missing {
        /// Serial ports that there are.
        others: Vec<PathBuf>,
    },
    /// The file is something else than a serial line.
    NoSerialLine {
        /// Serial ports that there are.
        others: Vec<PathBuf>,
    },
    /// This user may not use the port.
    Forbidden,
    /// Any other fault, as the system tells it.
    System(String),
}

impl PortFault {
    /// Returns the fault of a port that is not there.
    pub fn missing() -> Self {
        Self::Missing { others: serial_ports(Path::new(DEVICES)) }
    }

    /// Returns the fault of a file that is no serial line.
    #[cfg(unix)]
    pub(super) fn no_serial_line() -> Self {
        Self::NoSerialLine { others: serial_ports(Path::new(DEVICES)) }
    }

    /// Returns the fault of a port whose file the system does not open.
    pub(super) fn of_file(error: &Error) -> Self {
        match error.kind() {
            ErrorKind::NotFound | ErrorKind::NotADirectory => Self::missing(),
            ErrorKind::PermissionDenied => Self::Forbidden,
            #[cfg(unix)]
            ErrorKind::IsADirectory => Self::no_serial_line(),
            _ => Self::System(error.to_string()),
        }
    }
}

impl Display for PortFault {
    fn fmt(&self, to: &mut Formatter<'_>) -> fmt::Result {
        let others = match self {
            Self::Missing { others } => {
                to.write_str("it is not there")?;
                others
            }
            Self::NoSerialLine { others } => {
                to.write_str("it is no serial line")?;
                others
            }
            Self::Forbidden => return to.write_str("this user may not read and write it"),
            Self::System(reason) => return to.write_str(reason),
        };
        let named = others.iter().take(MOST_NAMED).map(|port| port.display().to_string()).collect::<Vec<_>>();
        match (named.as_slice(), others.len().saturating_sub(MOST_NAMED)) {
            ([], _) => to.write_str("; no serial port of a USB cable is there"),
            ([only], _) => write!(to, "; the one serial port is {only}"),
            ([first @ .., last], 0) => write!(to, "; the serial ports are {} and {last}", first.join(", ")),
            (named, more) => write!(to, "; the serial ports are {} and {more} more", named.join(", ")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_few_of_the_ports_that_there_are_are_named() {
        let said = |count: usize| {
            let others = (0..count).map(|n| PathBuf::from(format!("/dev/ttyUSB{n}"))).collect();
            PortFault::Missing { others }.to_string()
        };
        assert_eq!(said(0), "it is not there; no serial port of a USB cable is there");
        assert_eq!(said(1), "it is not there; the one serial port is /dev/ttyUSB0");
        assert_eq!(said(2), "it is not there; the serial ports are /dev/ttyUSB0 and /dev/ttyUSB1");
        let many =
            "it is not there; the serial ports are /dev/ttyUSB0, /dev/ttyUSB1, /dev/ttyUSB2 and 2 more";
        assert_eq!(said(5), many);
    }

    #[test]
    fn a_file_that_is_not_opened_says_why_in_words() {
        let of = |kind: ErrorKind| PortFault::of_file(&kind.into());
        assert!(of(ErrorKind::NotFound).to_string().starts_with("it is not there; "));
        assert!(of(ErrorKind::IsADirectory).to_string().starts_with("it is no serial line; "));
        assert_eq!(of(ErrorKind::PermissionDenied), PortFault::Forbidden);
    }
}
