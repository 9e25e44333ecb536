//! A bench: one pump with its driver, its record, and the thread that holds it.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

use pump_bench::calibration::Weighing;
use pump_bench::config::Config;
use pump_bench::pump_file::{DriverName, Pace};
use pump_bench::record::Purpose;
use pump_bench::report::Status;
use pump_bench::{Bench as DoseBench, Delivered, DoseError, DoseReport, Prepared, Session, units};
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;

use super::request::AskedDose;
use super::worker::{Call, Named, Signal, Worker, lock};
use crate::argument::{choice, quantity, word};
use crate::pump::Pump;
use crate::python::advice;
use crate::python::errors::{self, value};
use crate::python::{spare, warnings};

/// Methods of a bench that can move the motor.
const CALLS: [&str; 9] =
    ["dose", "prime", "purge", "run", "batch", "resume", "calibration_run", "home_sensor", "jog_rad"];

/// Compiled half of `pumpmodel.Bench`; use that instead.
#[pyclass(frozen, name = "_Bench", module = "pumpmodel._pumpmodel")]
pub(crate) struct Bench {
    pub(super) bench: Arc<DoseBench>,
    /// Name and temperature (°C) of the fluid, as the caller named it.
    pub(super) fluid: (Option<String>, Option<f64>),
    pub(super) worker: Worker,
    /// True once the notes of an opened session have become warnings.
    is_noted: AtomicBool,
    /// JSON of the dose or run that ended last.
    last: Mutex<Option<String>>,
}

/// A dose that was run: the command's JSON, and the note for an interrupted caller.
pub(super) struct Ran {
    pub(super) json: String,
    pub(super) note: String,
    /// Stand at a safety limit that has ended a run until it was stopped.
    pub(super) early: Option<DoseError>,
}

#[pymethods]
impl Bench {
    #[new]
    #[allow(clippy::too_many_arguments, reason = "keywords of one Python call")]
    #[pyo3(signature = (
        pump, *, driver, port, pace, state_dir, configure, accept_settings, confirm_pump, tube_limit, fluid, temperature
    ))]
    fn new(
        py: Python<'_>,
        pump: &Pump,
        driver: Option<&str>,
        port: Option<PathBuf>,
        pace: Option<&str>,
        state_dir: Option<PathBuf>,
        configure: bool,
        accept_settings: bool,
        confirm_pump: bool,
        tube_limit: Option<&Bound<'_, PyAny>>,
        fluid: Option<&str>,
        temperature: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let mut file = pump.file.clone();
        if let Some(limit) = tube_limit {
            let life_ml = quantity("tube_limit", "100L", limit, units::volume_ml)?;
            file.tube.life_ml = Some(life_ml);
        }
        let degc = temperature
            .map(|degc| quantity("temperature", "20degC", degc, units::temperature_degc))
            .transpose()?;
        file.fluid = file.fluid.changed_to(fluid, degc).map_err(value)?;
        let driver = driver.map(driver_named).transpose()?;
        if driver.unwrap_or(file.driver()) == DriverName::Sim {
            let given = [
                ("port", port.is_some()),
                ("configure", configure),
                ("accept_settings", accept_settings),
                ("confirm_pump", confirm_pump),
            ];
            if let Some((name, _)) = given.iter().find(|(_, given)| *given) {
                return Err(value(format_args!(
                    "{name} is given, but the motor is simulated; to move a real one name its driver, as \
                     driver=\"grbl\""
                )));
            }
        } else if pace.is_some() {
            return Err(value(
                "pace is given, but a real motor takes its time; allowed: none, or the simulated motor of \
                 driver=\"sim\"",
            ));
        }
        let pace = pace.map(|pace| word("pace", pace, Pace::ALL)).transpose()?;
        let state_dir = self::state_dir(state_dir)?;
        let bench = DoseBench::new(file, driver, &state_dir).map_err(|error| errors::dose(py, error))?;
        let bench =
            bench.at_port(port).paced(pace).configuring(configure).accepting_settings(accept_settings);
        let bench = bench.confirming_pump(confirm_pump);
        spare::room_for_threads(1)?;
        let (worker, bench) = Worker::new(bench).map_err(|error| {
            PyOSError::new_err(format!("no thread could be started for the bench: {error}"))
        })?;
        let fluid = (fluid.map(str::to_owned), degc);
        Ok(Self { bench, fluid, worker, is_noted: AtomicBool::new(false), last: Mutex::default() })
    }

    /// Pump, with the changes made when the bench was opened.
    #[getter]
    fn pump(&self) -> PyResult<Pump> {
        Pump::new(self.bench.file().clone())
    }

    /// Name of the driver that turns the motor.
    #[getter]
    fn driver(&self) -> &str {
        self.bench.drive_id()
    }

    /// Serial port of the motor's controller.
    #[getter]
    fn port(&self) -> Option<String> {
        self.bench.drive().port.as_ref().map(|port| port.display().to_string())
    }

    /// Folder of the journal.
    #[getter]
    fn folder(&self) -> PathBuf {
        self.bench.folder().path().to_owned()
    }

    /// True once the bench is closed.
    #[getter]
    fn closed(&self) -> bool {
        self.worker.is_closed()
    }

    /// Angle (rad), half width (rad) and carry (mL) on record.
    #[getter]
    fn stands(&self, py: Python<'_>) -> PyResult<(f64, f64, f64)> {
        let status = self.bench.stands().map_err(|error| errors::dose(py, error))?;
        Ok((status.angle_rad, status.half_width_rad, status.carry_ml))
    }

    /// Returns the record as `dose status --format json` prints it.
    fn status(&self, py: Python<'_>) -> PyResult<String> {
        Status::of(&self.bench).map(|status| status.json()).map_err(|error| errors::dose(py, error))
    }

    /// Plans a dose from the record without moving. Returns the JSON of a dry run.
    fn prepare(&self, py: Python<'_>, purpose: &str, asked: AskedDose<'_>) -> PyResult<String> {
        let request = asked.request(purpose_named(purpose)?, &self.weighing())?;
        let bench = &self.bench;
        let prepared = py.detach(|| bench.prepare(request)).map_err(|error| errors::dose(py, error))?;
        Ok(DoseReport::new(bench, &prepared, None).worded(advice::words).json())
    }

    /// Connects the motor, unless a dose is unfinished: then the next dose is refused anyway.
    fn connect(&self, py: Python<'_>) -> PyResult<()> {
        self.worker.call(
            py,
            Named::Motion("batch"),
            None,
            |()| "the motor is connected; nothing moved".to_owned(),
            |held, _| {
                let session = held.session()?;
                let refuses = session.state().is_some_and(|state| state.unfinished.is_some());
                if refuses { Ok(()) } else { session.connect() }
            },
        )
    }

    /// Runs a dose. Returns the JSON of the command.
    #[pyo3(signature = (purpose, asked, progress))]
    fn dose(
        &self,
        py: Python<'_>,
        purpose: &str,
        asked: AskedDose<'_>,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<String> {
        let request = asked.request(purpose_named(purpose)?, &self.weighing())?;
        self.run(py, "dose", progress, move |session, signal| {
            // No person watches the doses of a program.
            let is_free = session.state().is_none_or(|state| state.unfinished.is_none());
            if is_free && request.start_angle_rad.is_none() {
                call_off(session, signal);
                session.follow_home_policy(|_| signal.flow())?;
            }
            session.prepare(request)
        })
    }

    /// Makes the rest of an unfinished dose. Returns the JSON of the command.
    #[pyo3(signature = (asked, progress))]
    fn resume(
        &self,
        py: Python<'_>,
        asked: AskedDose<'_>,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<String> {
        let request = asked.request(Purpose::Dose, &self.weighing())?;
        self.run(py, "resume", progress, move |session, signal| {
            find_angle_of_rest(session, signal)?;
            session.prepare_rest(request)
        })
    }

    /// Begins a call that can move the motor, so that a stop reaches it. One that lasts has a `with` block for each
    /// of its motions.
    #[pyo3(signature = (name, *, lasts=false))]
    fn begin(&self, name: &str, lasts: bool) -> PyResult<Call> {
        let names = CALLS.map(|name| (name, name));
        Ok(Call::new(self.worker.begin(choice("name", name, &names)?), lasts))
    }

    /// Makes every call that has begun decelerate the motor, which holds. Returns the names of the calls.
    fn stop(&self) -> Vec<&'static str> {
        self.worker.stop()
    }

    /// JSON of the dose or run that ended last, also of one that was interrupted; None if the last one did not move.
    #[getter]
    fn last(&self) -> Option<String> {
        lock(&self.last).clone()
    }

    /// Gives the pump back.
    fn close(&self, py: Python<'_>) {
        py.detach(|| self.worker.close());
    }
}

impl Bench {
    /// Keeps the JSON of a dose or run that has ended.
    pub(super) fn keep_last(&self, json: Option<&String>) {
        *lock(&self.last) = json.cloned();
    }

    pub(super) fn weighing(&self) -> Weighing<'_> {
        Weighing::of(self.bench.file())
    }

    /// Takes the pump, and warns of what the record says of it before the first motion `name`: nothing has moved if a
    /// filter turns the warning into an exception. The report of the motion has the same notes.
    pub(super) fn warn_before(&self, py: Python<'_>, name: &'static str) -> PyResult<()> {
        if self.is_noted.load(Ordering::Relaxed) {
            return Ok(());
        }
        let notes = self.worker.call(
            py,
            Named::Motion(name),
            None,
            |_| "nothing moved".to_owned(),
            |held, _| held.notes_before(),
        )?;
        warnings::warn(py, &advice::worded(&notes))?;
        self.is_noted.store(true, Ordering::Relaxed);
        Ok(())
    }

    /// Runs the dose that `prepare` returns.
    fn run(
        &self,
        py: Python<'_>,
        name: &'static str,
        progress: Option<&Bound<'_, PyAny>>,
        prepare: impl FnOnce(&mut Session<'_>, &Arc<Signal>) -> Result<Prepared, DoseError> + Send + 'static,
    ) -> PyResult<String> {
        self.keep_last(None);
        self.warn_before(py, name)?;
        let ran = self.worker.call(
            py,
            Named::Motion(name),
            progress,
            |ran: &Ran| {
                self.keep_last(Some(&ran.json));
                ran.note.clone()
            },
            move |held, signal| {
                let bench = held.bench;
                let session = held.session()?;
                let prepared = prepare(session, signal)?;
                let delivered = deliver(session, &prepared, signal)?;
                let report = DoseReport::new(bench, &prepared, Some(&delivered)).worded(advice::words);
                let early = bench.ended_early(&delivered);
                Ok(Ran { json: report.json(), note: note(&delivered), early })
            },
        )?;
        self.keep_last(Some(&ran.json));
        let Some(early) = ran.early else { return Ok(ran.json) };
        let error = errors::dose(py, early);
        error.value(py).call_method1("add_note", (ran.note,))?;
        Err(error)
    }
}

/// Does as the pump file says if the angle of an unfinished dose was disturbed: no person watches its rest.
pub(super) fn find_angle_of_rest(session: &mut Session<'_>, signal: &Arc<Signal>) -> Result<(), DoseError> {
    if session.state().is_none_or(|state| state.unfinished.is_none()) {
        return Ok(());
    }
    call_off(session, signal);
    session.follow_home_policy(|_| signal.flow())
}

/// Runs a dose that `session` prepared.
pub(super) fn deliver(
    session: &mut Session<'_>,
    prepared: &Prepared,
    signal: &Arc<Signal>,
) -> Result<Delivered, DoseError> {
    signal.plans(prepared.plan.steps().unsigned_abs());
    call_off(session, signal);
    let planned = prepared.plan.steps().unsigned_abs();
    let mut dosed = 0;
    let delivered = session.run(prepared, |made| {
        // A retraction counts steps of its own once those of the dose are made.
        if made < dosed {
            dosed = planned;
        }
        dosed = dosed.max(made.min(planned));
        signal.made(dosed)
    })?;
    signal.ends(delivered.made);
    Ok(delivered)
}

/// Has the next motion of `session` called off if the caller wants no more by then. Nothing is unfinished after that.
pub(super) fn call_off(session: &mut Session<'_>, signal: &Arc<Signal>) {
    let signal = Arc::clone(signal);
    session.before_motion(move || signal.flow());
}

/// Returns the note on an interrupted caller's exception: the volume that was delivered.
pub(super) fn note(delivered: &Delivered) -> String {
    let volume_ml = delivered.volume_ml;
    if !delivered.completed && !delivered.unfinished && delivered.made == 0 {
        "the motion was stopped before its first step, and nothing is unfinished".to_owned()
    } else if !delivered.completed && !delivered.unfinished {
        format!("{volume_ml:.4} mL were delivered and are on record; the run is complete")
    } else if !delivered.completed {
        format!(
            "{volume_ml:.4} mL were delivered and are on record; bench.resume() makes the rest, bench.discard() \
             accepts the dose as it is"
        )
    } else if !delivered.sucked_back {
        format!(
            "{volume_ml:.4} mL were delivered, the whole dose; the volume sucked back afterwards is carried to the \
             next dose"
        )
    } else {
        format!("{volume_ml:.4} mL were delivered, the whole dose")
    }
}

/// Returns the folder of all records: the one that is named, or else that of the environment or the configuration.
pub(super) fn state_dir(named: Option<PathBuf>) -> PyResult<PathBuf> {
    match named {
        Some(dir) if dir.as_os_str().is_empty() => Err(value("state_dir is empty; name a folder")),
        Some(dir) => Ok(dir),
        None => match std::env::var_os("DOSE_STATE_DIR").filter(|dir| !dir.is_empty()) {
            Some(dir) => Ok(dir.into()),
            None => Config::of_user(None).map_err(errors::config)?.state_dir().map_err(value),
        },
    }
}

fn driver_named(name: &str) -> PyResult<DriverName> {
    word("driver", name, DriverName::ALL)
}

fn purpose_named(name: &str) -> PyResult<Purpose> {
    let purposes = [
        ("dose", Purpose::Dose),
        ("prime", Purpose::Prime),
        ("purge", Purpose::Purge),
        ("run", Purpose::Run),
    ];
    choice("purpose", name, &purposes)
}
