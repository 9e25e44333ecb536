//! SIGINT (Ctrl-C), SIGTERM and SIGHUP (the terminal is closed): the dose is stopped, not the process. Windows has
//! SIGBREAK instead of SIGHUP.

use std::io;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, LazyLock, OnceLock};

use pump_bench::drives::StopRequest;
#[cfg(unix)]
use signal_hook::consts::{SIGHUP, SIGXFSZ};
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

/// Signals that stop, with their names.
#[cfg(unix)]
const STOPS: [(i32, &str); 3] = [(SIGINT, "SIGINT"), (SIGTERM, "SIGTERM"), (SIGHUP, "SIGHUP")];

/// Signals that stop, with their names. Windows raises the last one at Ctrl+Break and when the console is closed; its
/// number is that of Microsoft's signal.h.
#[cfg(not(unix))]
const STOPS: [(i32, &str); 3] = [(SIGINT, "SIGINT"), (SIGTERM, "SIGTERM"), (21, "SIGBREAK")];

/// Number of the signal that came; 0 for none. Signals end the process while nothing watches for them.
static SIGNAL: LazyLock<Arc<AtomicUsize>> = LazyLock::new(Arc::default);

/// Why a supervising program stopped this one; empty while none did.
static REASON: OnceLock<String> = OnceLock::new();

/// The signals cannot be watched for.
#[derive(Debug)]
pub(crate) struct Unwatched(pub(crate) io::Error);

/// Lets a file that has grown to the process's limit be an error of its writing, as a full disk is. Otherwise the
/// system would end the process by SIGXFSZ in the midst of a motion.
#[cfg(unix)]
pub(crate) fn outlive_file_limits() {
    // Where the signal cannot be watched for, it ends the process as before.
    let _ = flag::register(SIGXFSZ, Arc::default());
}

/// A watch for these signals.
pub(crate) struct Interrupt(());

impl Interrupt {
    /// Watches for the signals from now on.
    pub(crate) fn watch() -> Result<Self, Unwatched> {
        for (number, _) in STOPS {
            flag::register_usize(number, Arc::clone(&SIGNAL), number as usize).map_err(Unwatched)?;
        }
        Ok(Self(()))
    }

    /// The signal that came, if one did.
    pub(crate) fn signal(&self) -> Option<i32> {
        signal()
    }

    /// Breaks a motion once a signal came.
    pub(crate) fn flow(&self) -> ControlFlow<()> {
        if self.signal().is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

/// The signal that came while one was watched for.
pub(crate) fn signal() -> Option<i32> {
    match SIGNAL.load(Ordering::Relaxed) {
        0 => None,
        number => i32::try_from(number).ok(),
    }
}

/// Stops as SIGTERM does, for this reason of a supervising program. The name of another signal stops as that one.
pub(crate) fn stop_for(reason: &str) {
    let signal = STOPS.into_iter().find(|(_, name)| *name == reason);
    if signal.is_none() && !reason.is_empty() {
        // The first reason is the one that counts.
        let _ = REASON.set(reason.to_owned());
    }
    let number = signal.map_or(SIGTERM, |(number, _)| number) as usize;
    let _ = SIGNAL.compare_exchange(0, number, Ordering::Relaxed, Ordering::Relaxed);
}

/// The request to stop that ends the waits for a device once a signal came.
pub(crate) fn stop_request() -> StopRequest {
    StopRequest::new(|| signal().is_some()).saying(|| signal().map(name))
}

/// The reason for which a supervising program stops this one. `None` for a signal.
pub(crate) fn reason() -> Option<&'static str> {
    REASON.get().map(String::as_str)
}

/// The name of a signal, or the reason of a supervising program, as the log keeps it.
pub(crate) fn name(signal: i32) -> String {
    if let Some(reason) = REASON.get() {
        return reason.clone();
    }
    let known = STOPS.into_iter().find(|(number, _)| *number == signal);
    known.map_or_else(|| format!("signal {signal}"), |(_, name)| name.to_owned())
}
