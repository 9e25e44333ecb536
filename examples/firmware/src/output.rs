//! Sends text to the host, a kilobyte at a time, since each call of the host stops the processor.

use core::fmt::{Error, Result, Write};

use cortex_m_semihosting::hio::{HostStream, hstdout};

pub struct Buffered {
    stream: HostStream,
    bytes: [u8; 1024],
    used: usize,
}

impl Buffered {
    pub fn new() -> Self {
        Self { stream: hstdout().expect("a host is attached"), bytes: [0; 1024], used: 0 }
    }

    pub fn flush(&mut self) -> Result {
        let used = self.bytes.get(..self.used).unwrap_or_default();
        self.used = 0;
        self.stream.write_all(used).map_err(|()| Error)
    }
}

impl Write for Buffered {
    fn write_str(&mut self, text: &str) -> Result {
        for byte in text.bytes() {
            if self.used == self.bytes.len() {
                self.flush()?;
            }
            if let Some(place) = self.bytes.get_mut(self.used) {
                *place = byte;
                self.used += 1;
            }
        }
        Ok(())
    }
}
