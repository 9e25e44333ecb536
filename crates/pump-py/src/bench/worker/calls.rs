//! The calls of a bench that are under way, and the stops that reach them.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, ThreadId};

use pyo3::prelude::*;

/// State of one call, or of a batch of calls, from its begin to its end. A stop stays: what begins later in the same
/// call does not move.
#[derive(Debug)]
pub(in crate::bench) struct Signal {
    /// Name of the method that was called.
    name: &'static str,
    /// True if the call can move the motor.
    moves: bool,
    stop: AtomicBool,
    /// True once the bench's thread works on the call.
    at_work: AtomicBool,
    /// Source of the wish to stop the motion.
    cause: Mutex<Option<String>>,
    /// Python thread that makes the call now.
    thread: Mutex<Option<ThreadId>>,
    /// Number of steps made.
    made: AtomicU64,
    /// Number of steps planned; 0 before the motion.
    planned: AtomicU64,
}

impl Signal {
    fn new(name: &'static str, moves: bool) -> Self {
        Self {
            name,
            moves,
            stop: AtomicBool::new(false),
            at_work: AtomicBool::new(false),
            cause: Mutex::default(),
            thread: Mutex::default(),
            made: AtomicU64::new(0),
            planned: AtomicU64::new(0),
        }
    }

    /// Name of the method that was called.
    pub(super) fn name(&self) -> &'static str {
        self.name
    }

    /// Tells if the caller wants the motion to stop.
    pub(in crate::bench) fn stopped(&self) -> bool {
        self.stop.load(Ordering::SeqCst)
    }

    /// Source of the wish to stop.
    pub(super) fn cause(&self) -> Option<String> {
        lock(&self.cause).clone()
    }

    /// Stops the motion. The first cause stays.
    pub(super) fn stop(&self, cause: &str) {
        lock(&self.cause).get_or_insert_with(|| cause.to_owned());
        self.stop.store(true, Ordering::SeqCst);
    }

    /// Notes that the bench's thread works on the call, or no longer does.
    pub(super) fn works(&self, at_work: bool) {
        self.at_work.store(at_work, Ordering::SeqCst);
    }

    /// Forgets the steps of an earlier motion of a batch.
    pub(super) fn restart(&self) {
        self.made.store(0, Ordering::Relaxed);
        self.planned.store(0, Ordering::Relaxed);
    }

    /// Notes the number of steps planned.
    pub(in crate::bench) fn plans(&self, steps: u64) {
        self.planned.store(steps, Ordering::Relaxed);
    }

    /// Notes the number of steps made. Breaks once the caller wants no more.
    pub(in crate::bench) fn made(&self, steps: u64) -> ControlFlow<()> {
        self.made.store(steps, Ordering::Relaxed);
        self.flow()
    }

    /// Notes the number of steps that a motion has made in all.
    pub(in crate::bench) fn ends(&self, steps: u64) {
        self.made.store(steps, Ordering::Relaxed);
    }

    /// Breaks once the caller wants no more.
    pub(in crate::bench) fn flow(&self) -> ControlFlow<()> {
        if self.stopped() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    /// Steps made and steps planned.
    pub(super) fn progress(&self) -> (u64, u64) {
        (self.made.load(Ordering::Relaxed), self.planned.load(Ordering::Relaxed))
    }
}

/// Every call that has begun and not ended, from any thread.
#[derive(Debug, Clone, Default)]
pub(super) struct Calls(Arc<Mutex<Vec<Arc<Signal>>>>);

impl Calls {
    /// Begins a call. It is part of the call that this thread makes already, if it makes one.
    pub(super) fn begin(&self, name: &'static str, moves: bool) -> Begun {
        let mut calls = lock(&self.0);
        let this = Some(thread::current().id());
        let outer = calls.iter().find(|call| *lock(&call.thread) == this);
        if let Some(outer) = outer {
            return Begun { calls: self.clone(), signal: Arc::clone(outer), is_part: true };
        }
        let signal = Arc::new(Signal::new(name, moves));
        calls.push(Arc::clone(&signal));
        Begun { calls: self.clone(), signal, is_part: false }
    }

    /// Stops every call that moves, and the one that the bench's thread works on. Returns their names.
    pub(super) fn stop(&self, cause: &str) -> Vec<&'static str> {
        let calls = lock(&self.0);
        let reached = calls.iter().filter(|call| call.moves || call.at_work.load(Ordering::SeqCst));
        reached
            .map(|call| {
                call.stop(cause);
                call.name
            })
            .collect()
    }

    fn end(&self, signal: &Arc<Signal>) {
        lock(&self.0).retain(|call| !Arc::ptr_eq(call, signal));
    }
}

/// A call from its begin until this is dropped.
pub(in crate::bench) struct Begun {
    calls: Calls,
    pub(super) signal: Arc<Signal>,
    /// True if another has begun the call, and ends it.
    is_part: bool,
}

impl Begun {
    fn end(&self) {
        if !self.is_part {
            self.calls.end(&self.signal);
        }
    }
}

impl Drop for Begun {
    fn drop(&mut self) {
        self.end();
    }
}

/// A call that Python has begun. Within its `with` block the calls of the thread are parts of it.
#[pyclass(frozen, name = "_Call", module = "pumpmodel._pumpmodel")]
pub(crate) struct Call {
    begun: Begun,
    /// True if the call goes on after a `with` block: a batch has one for each of its doses.
    lasts: bool,
}

impl Call {
    pub(in crate::bench) fn new(begun: Begun, lasts: bool) -> Self {
        Self { begun, lasts }
    }
}

#[pymethods]
impl Call {
    fn __enter__(this: Py<Self>) -> Py<Self> {
        let begun = &this.get().begun;
        if !begun.is_part {
            *lock(&begun.signal.thread) = Some(thread::current().id());
        }
        this
    }

    #[pyo3(signature = (kind, error, traceback))]
    fn __exit__(
        &self,
        kind: Option<&Bound<'_, PyAny>>,
        error: Option<&Bound<'_, PyAny>>,
        traceback: Option<&Bound<'_, PyAny>>,
    ) {
        let _ = (kind, error, traceback);
        if !self.begun.is_part {
            *lock(&self.begun.signal.thread) = None;
        }
        if !self.lasts {
            self.begun.end();
        }
    }

    /// Makes the motor of this call alone decelerate and hold. `cause` is for the log.
    fn stop(&self, cause: &str) {
        self.begun.signal.stop(cause);
    }

    /// True once a stop has reached the call.
    #[getter]
    fn stopped(&self) -> bool {
        self.begun.signal.stopped()
    }

    /// Ends the call. Ending twice is no error.
    fn end(&self) {
        self.begun.end();
    }
}

/// Locks a mutex. A panic of the last holder does not matter: the value stays usable.
pub(in crate::bench) fn lock<T>(of: &Mutex<T>) -> MutexGuard<'_, T> {
    of.lock().unwrap_or_else(PoisonError::into_inner)
}
