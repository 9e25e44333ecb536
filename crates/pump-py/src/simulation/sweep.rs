//! The steady states of many pumps at many speeds, on all cores.

use std::num::NonZero;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError, SyncSender};
use std::thread;
use std::time::{Duration, Instant};

use pump_bench::displacement::DisplacementError;
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;

use super::steady_state::{NUMBERS, States};
use crate::argument::{Argument, Floats, Items, speed};
use crate::pump::Pump;
use crate::python::{SignalCheck, errors, reserve, spare};

/// Longest wait for the next result before the next check for signals. With `SignalCheck`'s own 0.05 s a Ctrl-C is
/// heard within 0.1 s.
const PATIENCE: Duration = Duration::from_millis(40);
/// Time between two calls of `progress`.
const PROGRESS_EVERY: Duration = Duration::from_millis(100);
/// Largest number of points in a block: a few ms of work at usual speeds.
const BLOCK: usize = 64;
/// Number of results that are set to 0 between two checks for signals.
const CHUNK: usize = 1 << 20;
/// Least number of blocks for each thread, so that all threads end at about the same time.
const BLOCKS_EACH: usize = 8;
/// Largest number of answers of each thread that wait to be taken.
const ANSWERS_EACH: usize = 4;

/// Computes the steady state of every pump at every speed: an array of shape (pumps, speeds) for each attribute of a
/// `SteadyState` but the speed, in their order.
///
/// `first` is the number of the first pump in errors. `progress(done, total)` is called now and then and at the end.
#[pyfunction]
#[pyo3(signature = (pumps, *, speed_rpm=None, speed_rad_s=None, threads=None, first=0, progress=None))]
pub(crate) fn _steady_states<'py>(
    py: Python<'py>,
    pumps: Items<Py<Pump>>,
    speed_rpm: Argument<'_, 'py>,
    speed_rad_s: Argument<'_, 'py>,
    threads: Option<NonZero<usize>>,
    first: usize,
    progress: Option<Py<PyAny>>,
) -> PyResult<Vec<Py<PyAny>>> {
    let speeds_rad_s = speed::turning_rad_s(speed_rpm, speed_rad_s)?.into_values()?;
    let shape = vec![pumps.0.len(), speeds_rad_s.len()];
    let sweep = Arc::new(Sweep::new(pumps.0, speeds_rad_s));
    let threads = match threads {
        Some(threads) => threads,
        None => thread::available_parallelism()?,
    };
    let columns = py.detach(|| sweep.columns(threads.get(), first, progress))?;
    columns.into_iter().map(|values| Floats::Many { shape: shape.clone(), values }.into_frozen(py)).collect()
}

/// Work that the threads share.
struct Sweep {
    pumps: Vec<Py<Pump>>,
    speeds_rad_s: Vec<f64>,
    /// First point that no thread has taken.
    next: AtomicUsize,
    /// True once nobody waits for results any more.
    abandoned: AtomicBool,
}

/// Answer of a thread: a block of results from its first point on, or the first point that is refused.
type BlockAnswer = Result<(usize, Vec<[f64; NUMBERS]>), (usize, DisplacementError)>;

impl Sweep {
    fn new(pumps: Vec<Py<Pump>>, speeds_rad_s: Vec<f64>) -> Self {
        Self { pumps, speeds_rad_s, next: AtomicUsize::new(0), abandoned: AtomicBool::new(false) }
    }

    fn points(&self) -> usize {
        self.pumps.len() * self.speeds_rad_s.len()
    }

    /// Computes all results on `threads` threads. An early end does not wait for the threads: each ends after its
    /// current point, which may take long.
    fn columns(
        self: &Arc<Self>,
        threads: usize,
        first: usize,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<[Vec<f64>; NUMBERS]> {
        let points = self.points();
        let mut columns: [Vec<f64>; NUMBERS] = Default::default();
        let mut interrupt = SignalCheck::new();
        for column in &mut columns {
            reserve(column, points as u64)?;
            // The system hands out gigabytes slowly.
            while column.len() < points {
                interrupt.check()?;
                column.resize(points.min(column.len() + CHUNK), 0.0);
            }
        }
        let block = (points / threads / BLOCKS_EACH).clamp(1, BLOCK);
        let threads = threads.min(points.div_ceil(block));
        // Nothing that grows with the input is taken after this look.
        let threads = if threads == 0 { 0 } else { spare::threads_with_room(threads)? };
        // Threads wait where `progress` takes its time, so that their answers do not pile up.
        let (answers, answered) = mpsc::sync_channel(ANSWERS_EACH * threads);
        for _ in 0..threads {
            let (sweep, answers) = (Arc::clone(self), answers.clone());
            let started = thread::Builder::new().spawn(move || sweep.work(block, &answers));
            if let Err(error) = started {
                self.abandoned.store(true, Ordering::Relaxed);
                return Err(PyOSError::new_err(format!("no thread could be started: {error}")));
            }
        }
        drop(answers);
        let collected = self.collect(&mut columns, &answered, first, progress);
        self.abandoned.store(true, Ordering::Relaxed);
        collected.map(|()| columns)
    }

    /// Puts answers in place until every thread has ended. Threads take blocks in order and finish each block that they
    /// take, so the refused point that is reported is the first of all.
    fn collect(
        &self,
        columns: &mut [Vec<f64>; NUMBERS],
        answered: &mpsc::Receiver<BlockAnswer>,
        first: usize,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<()> {
        let mut done = 0;
        let mut refused: Option<(usize, DisplacementError)> = None;
        let mut interrupt = SignalCheck::new();
        let mut told = Instant::now();
        let tell = |done: usize| match &progress {
            Some(progress) => Python::attach(|py| progress.call1(py, (done, self.points())).map(drop)),
            None => Ok(()),
        };
        loop {
            interrupt.check()?;
            match answered.recv_timeout(PATIENCE) {
                Ok(Ok((start, block))) => {
                    for (point, numbers) in (start..).zip(&block) {
                        for (column, number) in columns.iter_mut().zip(numbers) {
                            column[point] = *number;
                        }
                    }
                    done += block.len();
                }
                Ok(Err((point, error))) => {
                    if refused.as_ref().is_none_or(|(earliest, _)| point < *earliest) {
                        refused = Some((point, error));
                    }
                }
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => break,
            }
            if told.elapsed() >= PROGRESS_EVERY {
                told = Instant::now();
                tell(done)?;
            }
        }
        match refused {
            None => tell(done),
            Some((point, error)) => {
                let pump = first + point / self.speeds_rad_s.len();
                Err(errors::within(format_args!("pumps[{pump}]"), errors::displacement(error)))
            }
        }
    }

    /// Computes blocks until none is left.
    fn work(&self, block: usize, answers: &SyncSender<BlockAnswer>) {
        let points = self.points();
        loop {
            let start = self.next.fetch_add(block, Ordering::Relaxed);
            if start >= points {
                return;
            }
            let mut results = Vec::with_capacity(block);
            let mut states: Option<(usize, States<'_>)> = None;
            for point in start..points.min(start + block) {
                if self.abandoned.load(Ordering::Relaxed) {
                    return;
                }
                let (pump, speed) = (point / self.speeds_rad_s.len(), point % self.speeds_rad_s.len());
                let (_, states) = match states.take() {
                    Some(prepared) if prepared.0 == pump => states.insert(prepared),
                    _ => states.insert((pump, States::of(&self.pumps[pump].get().by_speed))),
                };
                match states.numbers_at(self.speeds_rad_s[speed]) {
                    Ok(numbers) => results.push(numbers),
                    Err(error) => {
                        self.next.fetch_max(points, Ordering::Relaxed);
                        // A closed channel means that nobody waits.
                        let _ = answers.send(Err((point, error)));
                        return;
                    }
                }
            }
            if answers.send(Ok((start, results))).is_err() {
                return;
            }
        }
    }
}
