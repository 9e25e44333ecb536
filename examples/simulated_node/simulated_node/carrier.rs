//! The computer's part of a line: it carries the bytes from one end of a pseudo-terminal to the other.

use std::fs::{File, OpenOptions};
use std::io::{self, Read};

use super::line::Line;

/// Line of the board's own, on which a byte shows that the computer carries bytes.
///
/// A busy computer may leave the bytes of all pseudo-terminals lying for seconds. A board that went on meanwhile would
/// take that for a silent host.
#[derive(Debug)]
pub(super) struct Carrier {
    line: Line,
    other: File,
}

impl Carrier {
    /// Opens the line.
    pub(super) fn new() -> io::Result<Self> {
        let (line, path) = Line::new()?;
        Ok(Self { line, other: OpenOptions::new().read(true).open(path)? })
    }

    /// Waits until the computer has carried a byte.
    pub(super) fn carry(&mut self) -> io::Result<()> {
        self.line.write(&[0]);
        self.other.read_exact(&mut [0])
    }
}
