//! Racks: the compiled half of `pumpmodel.Rack`.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use pump_bench::Bench as DoseBench;
use pump_bench::config::Config;
use pump_bench::drives::StopRequest;
use pump_bench::pump_file::Pace;
use pump_bench::rack::{Rack as DoseRack, RackError, RackFile, RackReport};
use pyo3::prelude::*;

use super::bench::state_dir;
use super::worker::{cause, check_progress};
use crate::argument::word;
use crate::python::advice;
use crate::python::errors::{self, PumpError, value};

/// Time between two checks of a caller for signals.
const LOOK: Duration = Duration::from_millis(50);

/// Progress of each pump: its step, the motor steps made of it and those planned.
type Progress = Arc<Mutex<BTreeMap<String, (usize, u64, u64)>>>;

/// Compiled half of `pumpmodel.Rack`; use that instead.
#[pyclass(frozen, name = "_Rack", module = "pumpmodel._pumpmodel")]
pub(crate) struct Rack {
    rack: DoseRack,
    /// Stop of the run under way.
    running: Mutex<Option<Arc<AtomicBool>>>,
}

#[pymethods]
impl Rack {
    #[new]
    #[allow(clippy::too_many_arguments, reason = "keywords of one Python call")]
    #[pyo3(signature = (rack, text, *, pace, state_dir, configure, accept_settings, confirm_pump))]
    fn new(
        py: Python<'_>,
        rack: &str,
        text: Option<&str>,
        pace: Option<&str>,
        state_dir: Option<PathBuf>,
        configure: bool,
        accept_settings: bool,
        confirm_pump: bool,
    ) -> PyResult<Self> {
        let config = Config::of_user(None).map_err(errors::config)?;
        let file = match text {
            Some(text) => RackFile::parse(text, Path::new(rack)),
            None => RackFile::read(&config.find_rack(rack).map_err(errors::config)?),
        };
        let refused = |error| raised(py, error);
        let file = file.map_err(refused)?;
        let folder = self::state_dir(state_dir)?;
        let open = |pump| {
            let bench = DoseBench::new(pump, None, &folder).map_err(|error| errors::dose(py, error))?;
            let bench = bench.configuring(configure).accepting_settings(accept_settings);
            Ok(bench.confirming_pump(confirm_pump))
        };
        let pumps = file.pump_files(&config).map_err(refused)?;
        let benches = pumps.into_iter().map(open).collect::<PyResult<Vec<_>>>()?;
        // No person watches the runs of a program.
        let rack = DoseRack::new(file, benches).map_err(refused)?.unattended(true);
        // Simulated motors take no time, as those of a bench.
        let usual = if rack.is_simulated() { Pace::Fast } else { Pace::Real };
        let pace = pace.map_or(Ok(usual), |pace| word("pace", pace, Pace::ALL))?;
        Ok(Self { rack: rack.paced(pace), running: Mutex::default() })
    }

    /// Name of the rack.
    #[getter]
    fn name(&self) -> &str {
        self.rack.name()
    }

    /// Names of the pumps in the rack.
    #[getter]
    fn pumps(&self) -> Vec<String> {
        self.rack.members().iter().map(|member| member.name.clone()).collect()
    }

    /// Number of steps.
    #[getter]
    fn steps(&self) -> usize {
        self.rack.steps().len()
    }

    /// Plans and checks every step of every pump. Returns the JSON of a dry run.
    fn plan(&self, py: Python<'_>) -> PyResult<String> {
        let planned = py.detach(|| self.rack.rehearse());
        Ok(planned.map_err(|error| raised(py, error))?.worded(advice::words).json())
    }

    /// Runs the rack. Returns the JSON of the command. A fault has it as `_rack`.
    fn run(&self, py: Python<'_>, progress: Option<&Bound<'_, PyAny>>) -> PyResult<String> {
        check_progress(progress, 4)?;
        let stop = Arc::new(AtomicBool::new(false));
        {
            let mut running = self.running.lock().unwrap_or_else(PoisonError::into_inner);
            if running.is_some() {
                return Err(PumpError::new_err("this rack runs already, in another thread; nothing moved"));
            }
            *running = Some(Arc::clone(&stop));
        }
        let ended = self.run_until(py, &stop, progress);
        *self.running.lock().unwrap_or_else(PoisonError::into_inner) = None;
        ended
    }

    /// Has every motor of the run under way decelerate and hold.
    fn stop(&self) {
        if let Some(stop) = &*self.running.lock().unwrap_or_else(PoisonError::into_inner) {
            stop.store(true, Ordering::Relaxed);
        }
    }
}

impl Rack {
    /// Runs the rack in a thread, while this one hears signals and tells the progress.
    fn run_until(
        &self,
        py: Python<'_>,
        stop: &Arc<AtomicBool>,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<String> {
        let told = Progress::default();
        let (asked, noted) = (Arc::clone(stop), Arc::clone(&told));
        let thrower: Arc<Mutex<Option<String>>> = Arc::default();
        let told_cause = Arc::clone(&thrower);
        let asked = StopRequest::new(move || asked.load(Ordering::Relaxed)).saying(move || {
            let cause = told_cause.lock().unwrap_or_else(PoisonError::into_inner).clone();
            Some(cause.unwrap_or_else(|| "Rack.stop()".to_owned()))
        });
        let rack = self.rack.clone().stopping_on(asked);
        let (sender, mut ended) = channel();
        let run = move || {
            let report = rack.run(|progress| {
                let stands = (progress.step, progress.made, progress.steps);
                let mut noted = noted.lock().unwrap_or_else(PoisonError::into_inner);
                noted.insert(progress.pump.to_owned(), stands);
            });
            // The caller may be gone.
            let _ = sender.send(report);
        };
        thread::Builder::new().name("pumpmodel rack".to_owned()).spawn(run)?;
        let (mut thrown, mut heard) = (None, BTreeMap::new());
        let report = loop {
            let waiting = &mut ended;
            match py.detach(move || waiting.recv_timeout(LOOK)) {
                Ok(report) => break report,
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => {
                    return Err(PumpError::new_err("the rack's thread has ended; open the rack again"));
                }
            }
            if thrown.is_none()
                && let Err(error) = py.check_signals().and_then(|()| tell(progress, &told, &mut heard))
            {
                *thrower.lock().unwrap_or_else(PoisonError::into_inner) = Some(cause(py, &error));
                stop.store(true, Ordering::Relaxed);
                thrown = Some(error);
            }
        };
        if thrown.is_none() {
            thrown = tell(progress, &told, &mut heard).err();
        }
        match (report, thrown) {
            (Ok(report), thrown) => finished(py, report.worded(advice::words), thrown),
            (Err(RackError::Stopped), Some(thrown)) => {
                thrown.value(py).call_method1("add_note", ("nothing moved",))?;
                Err(thrown)
            }
            (Err(error), thrown) => {
                let error = raised(py, error);
                error.set_cause(py, thrown);
                Err(error)
            }
        }
    }
}

/// Calls `progress` for each pump that has made steps since the last call.
fn tell(
    progress: Option<&Bound<'_, PyAny>>,
    told: &Progress,
    heard: &mut BTreeMap<String, (usize, u64, u64)>,
) -> PyResult<()> {
    let Some(progress) = progress else { return Ok(()) };
    let told = told.lock().unwrap_or_else(PoisonError::into_inner).clone();
    for (pump, stands) in told {
        if heard.insert(pump.clone(), stands) != Some(stands) {
            let (step, made, steps) = stands;
            progress.call1((pump, step, made, steps))?;
        }
    }
    Ok(())
}

/// Returns the JSON of a rack that has ended, or raises what ended it.
fn finished(py: Python<'_>, mut report: RackReport, thrown: Option<PyErr>) -> PyResult<String> {
    let json = report.json();
    let has_moved = report.has_moved();
    let others = report.others_in_words().map_or(String::new(), |others| format!(", and {others}"));
    let note = format!(
        "{:.4} mL were delivered in all and are on record; open a Bench of a pump to resume() or discard() its rest",
        report.total.delivered_ml
    );
    match (report.fault.take(), thrown) {
        (None, None) => Ok(json),
        (None, Some(thrown)) => {
            thrown.value(py).call_method1("add_note", (note,))?;
            Err(thrown)
        }
        (Some(fault), thrown) => {
            let error = errors::dose(py, fault.error);
            let failed = match has_moved {
                true => format!("pump `{}` of the rack failed{others}; {note}", fault.pump),
                false => {
                    format!("pump `{}` of the rack was refused; the rack moved no motor", fault.pump)
                }
            };
            error.value(py).call_method1("add_note", (failed,))?;
            error.value(py).setattr("_rack", json)?;
            error.set_cause(py, thrown);
            Err(error)
        }
    }
}

/// Maps an error of a rack: bad steps are a `ValueError`, and an error of a pump is that pump's, with its name.
fn raised(py: Python<'_>, error: RackError) -> PyErr {
    let place = error.to_string();
    match error {
        RackError::Read { path, source } if source.raw_os_error().is_some() => errors::file(&path, &source),
        RackError::Pump { source, .. } => errors::within(place, errors::config(*source)),
        RackError::Dose { source, .. } => errors::within(place, errors::dose(py, *source)),
        RackError::Several { first, others } => {
            let raised = raised(py, *first);
            for other in &others {
                // A note that cannot be added must not hide the refusal.
                let _ = raised.value(py).call_method1("add_note", (advice::told(other),));
            }
            raised
        }
        RackError::Stopped => PumpError::new_err("the rack was stopped before it began; nothing moved"),
        error => value(advice::told(&error)),
    }
}
