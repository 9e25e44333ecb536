//! The thread that holds a pump: one session for as long as a Python `Bench` is open, whichever thread calls it.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use pump_bench::{Bench, DoseError, Session};
use pyo3::prelude::*;

use crate::errors::{self, PumpError};

/// Between two looks of a caller for signals, and of an idle session for a motor that is to be let go.
const LOOK: Duration = Duration::from_millis(50);

/// What a caller and the thread tell each other about one call.
#[derive(Debug, Default)]
pub(crate) struct Signal {
    stop: AtomicBool,
    /// Steps made.
    made: AtomicU64,
    /// Steps planned; 0 before it moves.
    planned: AtomicU64,
}

impl Signal {
    pub(crate) fn stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    pub(crate) fn plans(&self, steps: u64) {
        self.planned.store(steps, Ordering::Relaxed);
    }

    /// Notes that so many steps are made; breaks once the caller wants no more.
    pub(crate) fn made(&self, steps: u64) -> std::ops::ControlFlow<()> {
        self.made.store(steps, Ordering::Relaxed);
        if self.stopped() { std::ops::ControlFlow::Break(()) } else { std::ops::ControlFlow::Continue(()) }
    }
}

/// The bench with its session, once something needed one.
pub(crate) struct Held<'a> {
    pub(crate) bench: &'a Bench,
    pub(crate) session: Option<Session<'a>>,
    /// What failed while nobody called.
    unheard: Option<DoseError>,
}

impl<'a> Held<'a> {
    /// The session; takes the pump if this process does not have it yet.
    pub(crate) fn session(&mut self) -> Result<&mut Session<'a>, DoseError> {
        if let Some(error) = self.unheard.take() {
            return Err(error);
        }
        match &mut self.session {
            Some(session) => Ok(session),
            none => Ok(none.insert(self.bench.session()?)),
        }
    }

    fn release_when_due(&mut self) {
        if let Some(Err(error)) = self.session.as_mut().map(Session::release_when_due) {
            self.unheard = Some(error);
        }
    }
}

type Job = Box<dyn FnOnce(&mut Held<'_>) + Send>;

/// A bench on a thread of its own.
pub(crate) struct Worker {
    jobs: Mutex<Option<Sender<Job>>>,
    thread: Mutex<Option<JoinHandle<()>>>,
    /// The call under way.
    running: Arc<Mutex<Option<Arc<Signal>>>>,
    /// A forked process has no such thread.
    process: u32,
}

impl Worker {
    pub(crate) fn new(bench: Arc<Bench>) -> std::io::Result<Self> {
        let (sender, jobs) = channel();
        let thread =
            thread::Builder::new().name("pumpmodel bench".to_owned()).spawn(move || work(&bench, &jobs))?;
        Ok(Self {
            jobs: Mutex::new(Some(sender)),
            thread: Mutex::new(Some(thread)),
            running: Arc::default(),
            process: std::process::id(),
        })
    }

    /// Has the thread do `job` and waits for it while other Python threads run. A signal's exception, or one of `progress`,
    /// which is told how many steps of how many are made, stops the motor and is raised once all is on record; `note` says
    /// on it what became of the call.
    pub(crate) fn call<T: Send + 'static>(
        &self,
        py: Python<'_>,
        progress: Option<&Bound<'_, PyAny>>,
        note: impl Fn(&T) -> String,
        job: impl FnOnce(&mut Held<'_>, &Signal) -> Result<T, DoseError> + Send + 'static,
    ) -> PyResult<T> {
        if self.process != std::process::id() {
            return Err(PumpError::new_err("this bench was opened by another process; open it in this one"));
        }
        let signal = Arc::new(Signal::default());
        let mut result = self.send(Arc::clone(&signal), job)?;
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
                && let Err(error) = py.check_signals().and_then(|()| tell(progress, &signal, &mut told))
            {
                signal.stop.store(true, Ordering::Relaxed);
                raised = Some(error);
            }
        };
        match (ended, raised) {
            (Ok(Some(done)), None) => {
                if let Err(error) = tell(progress, &signal, &mut told) {
                    error.value(py).call_method1("add_note", (note(&done),))?;
                    return Err(error);
                }
                Ok(done)
            }
            (Ok(None), None) => Err(PumpError::new_err("stopped before it began; nothing was moved")),
            (Ok(done), Some(error)) => {
                let words = done.as_ref().map_or("nothing was moved".to_owned(), note);
                error.value(py).call_method1("add_note", (words,))?;
                Err(error)
            }
            (Err(error), None) => Err(errors::dose(py, error)),
            (Err(error), Some(raised)) => {
                let error = errors::dose(py, error);
                error.set_cause(py, Some(raised));
                Err(error)
            }
        }
    }

    fn send<T: Send + 'static>(
        &self,
        signal: Arc<Signal>,
        job: impl FnOnce(&mut Held<'_>, &Signal) -> Result<T, DoseError> + Send + 'static,
    ) -> PyResult<Receiver<Result<Option<T>, DoseError>>> {
        let (sender, result) = channel();
        let running = Arc::clone(&self.running);
        let job: Job = Box::new(move |held| {
            let begun = !signal.stopped();
            *lock(&running) = Some(Arc::clone(&signal));
            let ended = if begun { job(held, &signal).map(Some) } else { Ok(None) };
            *lock(&running) = None;
            // A caller that has gone does not want to know.
            let _ = sender.send(ended);
        });
        let sent = lock(&self.jobs).as_ref().is_some_and(|jobs| jobs.send(job).is_ok());
        if sent { Ok(result) } else { Err(PumpError::new_err("this bench is closed; open it again")) }
    }

    /// Has the motor of the call under way decelerate and hold.
    pub(crate) fn stop(&self) {
        if let Some(signal) = lock(&self.running).as_ref() {
            signal.stop.store(true, Ordering::Relaxed);
        }
    }

    pub(crate) fn is_closed(&self) -> bool {
        lock(&self.jobs).is_none()
    }

    /// Lets the calls under way end and gives the pump back.
    pub(crate) fn close(&self) {
        drop(lock(&self.jobs).take());
        let thread = lock(&self.thread).take();
        if let Some(thread) = thread.filter(|_| self.process == std::process::id()) {
            // A job that panicked has told its caller.
            let _ = thread.join();
        }
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        self.close();
    }
}

/// Does jobs until there will be no more.
fn work(bench: &Bench, jobs: &Receiver<Job>) {
    let mut held = Held { bench, session: None, unheard: None };
    loop {
        match jobs.recv_timeout(LOOK) {
            Ok(job) => job(&mut held),
            Err(RecvTimeoutError::Timeout) => held.release_when_due(),
            Err(RecvTimeoutError::Disconnected) => return,
        }
    }
}

/// Tells `progress` how far a motion is, unless it knows.
fn tell(progress: Option<&Bound<'_, PyAny>>, signal: &Signal, told: &mut u64) -> PyResult<()> {
    let (made, planned) = (signal.made.load(Ordering::Relaxed), signal.planned.load(Ordering::Relaxed));
    if let Some(progress) = progress.filter(|_| planned > 0 && made != *told) {
        *told = made;
        progress.call1((made, planned))?;
    }
    Ok(())
}

/// What a lock guards stays usable whatever its last holder did.
fn lock<T>(of: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    of.lock().unwrap_or_else(PoisonError::into_inner)
}
