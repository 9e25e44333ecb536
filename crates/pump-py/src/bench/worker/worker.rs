//! The thread that holds a pump: one session while a Python `Bench` is open, for callers on any thread.

use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use pump_bench::balance::BalanceError;
use pump_bench::drives::{DriveError, StopRequest};
use pump_bench::notice::Notice;
use pump_bench::{Bench, DoseError, Session};
use pyo3::prelude::*;

use super::calls::{Begun, Calls, Signal, lock};
use super::progress::check_progress;
use crate::python::advice;
use crate::python::errors::{self, PumpError, StoppedError};
use crate::python::spare;
use crate::python::warnings;

/// Time between two checks of a caller for signals, and of an idle session for a motor that is due for release.
const LOOK: Duration = Duration::from_millis(50);

/// Number of threads that a call may start: the journal's, and those of a device and of a balance.
const THREADS: usize = 3;

/// A bench, with its session once a call has needed one.
pub(in crate::bench) struct Held<'a> {
    pub(in crate::bench) bench: &'a Bench,
    pub(in crate::bench) session: Option<Session<'a>>,
    /// Failure that happened between two calls.
    unheard: Option<DoseError>,
    /// Notes of the session that have become warnings before a motion.
    warned: Vec<Notice>,
}

impl<'a> Held<'a> {
    /// Returns the session, and takes the pump if this bench does not hold it yet.
    pub(in crate::bench) fn session(&mut self) -> Result<&mut Session<'a>, DoseError> {
        if let Some(error) = self.unheard.take() {
            return Err(error);
        }
        match &mut self.session {
            Some(session) => Ok(session),
            none => Ok(none.insert(self.bench.session()?)),
        }
    }

    /// Returns the notes that the next motion's report shows, to be warned of before it.
    pub(in crate::bench) fn notes_before(&mut self) -> Result<Vec<Notice>, DoseError> {
        self.warned = self.session()?.pending_notes().to_vec();
        Ok(self.warned.clone())
    }

    /// Returns the notes of the session that nothing has told.
    fn notes_untold(&mut self) -> Vec<Notice> {
        let mut notes = self.session.as_mut().map_or_else(Vec::new, Session::notes);
        notes.retain(|note| !self.warned.contains(note));
        notes
    }

    /// Releases an idle motor when its time has come.
    fn release_when_due(&mut self) {
        if let Some(Err(error)) = self.session.as_mut().map(Session::release_when_due) {
            self.unheard = Some(error);
        }
    }
}

type Job = Box<dyn FnOnce(&mut Held<'_>) + Send>;

/// Name of a method, and the reach of a stop: one that moves the motor is stopped before it begins too.
#[derive(Debug, Clone, Copy)]
pub(in crate::bench) enum Named {
    /// A call that can turn the motor.
    Motion(&'static str),
    /// A call that changes the record.
    Entry(&'static str),
}

impl Named {
    fn name(self) -> &'static str {
        match self {
            Self::Motion(name) | Self::Entry(name) => name,
        }
    }

    fn moves(self) -> bool {
        matches!(self, Self::Motion(_))
    }
}

/// Failure of a call, with the notes of the session that no result can tell.
struct Failed {
    error: DoseError,
    notes: Vec<Notice>,
}

/// A bench on a thread of its own.
pub(in crate::bench) struct Worker {
    jobs: Mutex<Option<Sender<Job>>>,
    thread: Mutex<Option<JoinHandle<()>>>,
    /// Signal of the call that the thread works on.
    running: Arc<Mutex<Option<Arc<Signal>>>>,
    /// Calls that have begun and not ended.
    calls: Calls,
    /// Process that started the thread; a forked process does not have it.
    process: u32,
}

impl Worker {
    /// Starts the thread.
    ///
    /// A stop of the call under way ends its waits for a device too.
    pub(in crate::bench) fn new(bench: Bench) -> std::io::Result<(Self, Arc<Bench>)> {
        let (sender, jobs) = channel();
        let running: Arc<Mutex<Option<Arc<Signal>>>> = Arc::default();
        let asked = Arc::clone(&running);
        let stop = StopRequest::new(move || lock(&asked).as_ref().is_some_and(|signal| signal.stopped()));
        let told = Arc::clone(&running);
        let stop = stop.saying(move || lock(&told).as_ref().and_then(|signal| signal.cause()));
        let bench = Arc::new(bench.stopping_on(stop));
        let held = Arc::clone(&bench);
        let thread =
            thread::Builder::new().name("pumpmodel bench".to_owned()).spawn(move || work(&held, &jobs))?;
        let worker = Self {
            jobs: Mutex::new(Some(sender)),
            thread: Mutex::new(Some(thread)),
            running,
            calls: Calls::default(),
            process: std::process::id(),
        };
        Ok((worker, bench))
    }

    /// Begins a call that can move the motor. A stop reaches it from now on.
    pub(in crate::bench) fn begin(&self, name: &'static str) -> Begun {
        self.calls.begin(name, true)
    }

    /// Makes the thread do `job` for the call that this Python thread has begun, or else for one of `name` that begins
    /// and ends here. Waits for it while other Python threads run.
    ///
    /// `progress` is called with the steps made and the steps planned. Its exception, or a signal's, stops the motor
    /// and is raised once all is on record. `note` adds the outcome of the call to the exception. The notes of a call
    /// that fails become warnings.
    pub(in crate::bench) fn call<T: Send + 'static>(
        &self,
        py: Python<'_>,
        name: Named,
        progress: Option<&Bound<'_, PyAny>>,
        note: impl Fn(&T) -> String,
        job: impl FnOnce(&mut Held<'_>, &Arc<Signal>) -> Result<T, DoseError> + Send + 'static,
    ) -> PyResult<T> {
        if self.process != std::process::id() {
            return Err(PumpError::new_err(
                "another process opened this bench; open the bench in this process",
            ));
        }
        // A motion that begins has memory for its end.
        spare::room_for_threads(THREADS)?;
        check_progress(progress, 2)?;
        let begun = self.calls.begin(name.name(), name.moves());
        let signal = &begun.signal;
        signal.restart();
        let mut result = self.send(Arc::clone(signal), job)?;
        let mut raised: Option<PyErr> = None;
        let mut told = 0;
        let ended = loop {
            let waiting = &mut result;
            match py.detach(move || waiting.recv_timeout(LOOK)) {
                Ok(ended) => break ended,
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => {
                    return Err(PumpError::new_err("the bench's thread has ended; open the bench again"));
                }
            }
            if raised.is_none()
                && let Err(error) = py.check_signals().and_then(|()| tell(progress, signal, &mut told))
            {
                signal.stop(&cause(py, &error));
                raised = Some(error);
            }
        };
        let ended = ended
            .map_err(|Failed { error, notes }| (error, warnings::warn(py, &advice::worded(&notes)).err()));
        match (ended, raised) {
            (Ok(Some(done)), None) => {
                if let Err(error) = tell(progress, signal, &mut told) {
                    error.value(py).call_method1("add_note", (note(&done),))?;
                    return Err(error);
                }
                Ok(done)
            }
            (Ok(None), None) => Err(stopped(signal)),
            (Ok(done), Some(error)) => {
                let words = done.as_ref().map_or("nothing moved".to_owned(), note);
                error.value(py).call_method1("add_note", (words,))?;
                Err(error)
            }
            (Err((DoseError::Connection(DriveError::Interrupted), _)), Some(error)) => {
                error.value(py).call_method1("add_note", ("nothing moved",))?;
                Err(error)
            }
            (Err((error, None)), None) if signal.stopped() && is_stop(&error) => Err(stopped(signal)),
            (Err((error, warned)), raised) => {
                let error = errors::dose(py, error);
                // A warning that the user made an exception does not take the failure's place.
                if let Some(cause) = raised.or(warned) {
                    error.set_cause(py, Some(cause));
                }
                Err(error)
            }
        }
    }

    /// Queues `job` for the thread, and returns the channel of its result.
    fn send<T: Send + 'static>(
        &self,
        signal: Arc<Signal>,
        job: impl FnOnce(&mut Held<'_>, &Arc<Signal>) -> Result<T, DoseError> + Send + 'static,
    ) -> PyResult<Receiver<Result<Option<T>, Failed>>> {
        let (sender, result) = channel();
        let running = Arc::clone(&self.running);
        let job: Job = Box::new(move |held| {
            let begun = !signal.stopped();
            *lock(&running) = Some(Arc::clone(&signal));
            signal.works(true);
            let ended = if begun { job(held, &signal).map(Some) } else { Ok(None) };
            signal.works(false);
            let ended = ended.map_err(|error| Failed { error, notes: held.notes_untold() });
            *lock(&running) = None;
            // The caller may be gone.
            let _ = sender.send(ended);
        });
        let sent = lock(&self.jobs).as_ref().is_some_and(|jobs| jobs.send(job).is_ok());
        if sent { Ok(result) } else { Err(PumpError::new_err("this bench is closed; open it again")) }
    }

    /// Makes the motor decelerate and hold, and every call that has begun. Returns their names.
    pub(in crate::bench) fn stop(&self) -> Vec<&'static str> {
        self.calls.stop("Bench.stop()")
    }

    /// Tells if the bench is closed.
    pub(in crate::bench) fn is_closed(&self) -> bool {
        lock(&self.jobs).is_none()
    }

    /// Waits for the calls under way, and gives the pump back.
    pub(in crate::bench) fn close(&self) {
        drop(lock(&self.jobs).take());
        let thread = lock(&self.thread).take();
        if let Some(thread) = thread.filter(|_| self.process == std::process::id()) {
            // A job that panicked has closed its caller's channel.
            let _ = thread.join();
        }
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        self.close();
    }
}

/// Does jobs until the bench is closed.
fn work(bench: &Bench, jobs: &Receiver<Job>) {
    let mut held = Held { bench, session: None, unheard: None, warned: Vec::new() };
    loop {
        match jobs.recv_timeout(LOOK) {
            Ok(job) => job(&mut held),
            Err(RecvTimeoutError::Timeout) => held.release_when_due(),
            Err(RecvTimeoutError::Disconnected) => return,
        }
    }
}

/// Returns the name of an exception that stops a motion, as `KeyboardInterrupt`, for the log.
pub(in crate::bench) fn cause(py: Python<'_>, error: &PyErr) -> String {
    error.get_type(py).name().map_or_else(|_| "an exception".to_owned(), |name| name.to_string())
}

/// Calls `progress` if steps were made since the last call.
fn tell(progress: Option<&Bound<'_, PyAny>>, signal: &Signal, told: &mut u64) -> PyResult<()> {
    let (made, planned) = signal.progress();
    if let Some(progress) = progress.filter(|_| planned > 0 && made != *told) {
        *told = made;
        progress.call1((made, planned))?;
    }
    Ok(())
}

/// Tells if a stop has ended a call before its motion, so that nothing moved.
fn is_stop(error: &DoseError) -> bool {
    matches!(
        error,
        DoseError::Connection(DriveError::Interrupted) | DoseError::Balance(BalanceError::Stopped)
    )
}

/// Returns the exception of a call that was stopped before its motion.
fn stopped(signal: &Signal) -> PyErr {
    StoppedError::new_err(format!("{} was stopped before its motion; nothing was delivered", signal.name()))
}
