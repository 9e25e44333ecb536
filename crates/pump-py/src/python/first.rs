//! Memory that a first call would take, taken when the module is loaded.
//!
//! The system gives the main thread its stack page by page, and ends the process where it has no page left. Destructors
//! of a thread's own values are registered at their first use, which ends the process too where there is no room.

use std::hint::black_box;
use std::sync::mpsc::channel;
use std::thread;
use std::time::Duration;

use pyo3::prelude::*;

use super::spare;

/// Bytes of the stack that are touched. A plan takes a quarter of a megabyte.
const STACK: usize = 512 << 10;

/// Waits for an answer that never comes.
const WAITS: usize = 3;

/// Time of each of them.
const WAIT: Duration = Duration::from_millis(1);

/// Takes what first calls take. A module that is loaded by another thread than the main one leaves the stack alone:
/// other threads have theirs from the beginning.
pub(crate) fn take(py: Python<'_>) -> PyResult<()> {
    spare::room_for_threads(1)?;
    let threading = py.import("threading")?;
    let is_main = threading.call_method0("current_thread")?.is(&threading.call_method0("main_thread")?);
    if is_main {
        touch_stack();
    }
    // The values of a thread that waits for another one, as for the thread of a bench. An answer that is there already
    // is not waited for, so this one never comes. A busy computer may have let the time pass before the wait began.
    let (sender, receiver) = channel::<()>();
    for _ in 0..WAITS {
        receiver.recv_timeout(WAIT).ok();
    }
    let answers = thread::Builder::new().spawn(move || drop(sender))?;
    // The thread has nothing more to do.
    drop(answers.join());
    Ok(())
}

#[inline(never)]
fn touch_stack() {
    let pages = [0_u8; STACK];
    black_box(&pages);
}
