//! The ports that this process has open. No other process can open them, so the drives of this one share them.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError, Weak};

/// Ports that are open as long as a drive uses what is at their end.
#[derive(Debug)]
pub(in crate::drives) struct OpenPorts<T>(Mutex<Vec<OpenPort<T>>>);

#[derive(Debug)]
struct OpenPort<T> {
    device: PathBuf,
    baud: u32,
    end: Weak<T>,
}

/// Refusal to share a port.
#[derive(Debug)]
pub(in crate::drives) enum NotShared<E> {
    /// The port is open at another rate.
    #[cfg_attr(
        not(any(feature = "grbl", feature = "node")),
        allow(dead_code, reason = "a Klipper board is not shared at any rate")
    )]
    Rate {
        /// Path of the port.
        device: PathBuf,
        /// Rate of the port, in bits per second.
        open_baud: u32,
    },
    /// The port was not opened.
    Open(E),
}

impl<T> OpenPorts<T> {
    /// Returns no ports.
    pub(in crate::drives) const fn new() -> Self {
        Self(Mutex::new(Vec::new()))
    }

    /// Shares what is at the end of a port, or opens the port. One that `is_broken` is not shared any more.
    pub(in crate::drives) fn share<E>(
        &self,
        port: Option<&Path>,
        baud: u32,
        is_broken: impl Fn(&T) -> bool,
        open: impl FnOnce() -> Result<T, E>,
    ) -> Result<Arc<T>, NotShared<E>> {
        let mut ports = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        ports.retain(|port| port.end.strong_count() > 0);
        let device = port.map(|port| port.canonicalize().unwrap_or_else(|_| port.to_owned()));
        let device = device.unwrap_or_default();
        for there in ports.iter().filter(|there| there.device == device) {
            let Some(end) = there.end.upgrade().filter(|end| !is_broken(end)) else { continue };
            if there.baud != baud {
                return Err(NotShared::Rate { device, open_baud: there.baud });
            }
            return Ok(end);
        }
        let end = Arc::new(open().map_err(NotShared::Open)?);
        ports.push(OpenPort { device, baud, end: Arc::downgrade(&end) });
        Ok(end)
    }
}
