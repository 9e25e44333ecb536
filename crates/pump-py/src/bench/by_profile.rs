//! Runs that follow a flow over time.

use std::path::PathBuf;

use pump_bench::DoseReport;
use pump_bench::dosing::FlowProfile;
use pump_bench::files::{MOST_TABLE_BYTES, read_text};
use pump_bench::record::Purpose;
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;

use super::bench::{Bench, Ran, call_off, note};
use super::request::AskedDose;
use super::worker::Named;
use crate::python::advice;
use crate::python::errors::{self, value};

/// Flow over time from Python: its name, its file, or its times and flows.
type AskedFlow = (String, Option<PathBuf>, Vec<f64>, Vec<f64>);

/// Returns the profile, which runs the other way in reverse.
fn profile((name, path, times_s, flows_ml_s): AskedFlow, is_reverse: bool) -> PyResult<FlowProfile> {
    let profile = match path {
        Some(path) => {
            let text = read_text(&path, MOST_TABLE_BYTES)
                .map_err(|error| PyOSError::new_err(format!("{}: {error}", path.display())))?;
            FlowProfile::parse(&name, &text)
        }
        None => FlowProfile::from_columns(&name, &times_s, &flows_ml_s),
    };
    let profile = profile.map_err(|error| value(advice::told(&error)))?;
    Ok(if is_reverse { profile.reversed() } else { profile })
}

#[pymethods]
impl Bench {
    /// Plans a flow over time from the record without moving. Returns the JSON of a dry run.
    fn prepare_profile(&self, py: Python<'_>, asked: AskedDose<'_>, profile: AskedFlow) -> PyResult<String> {
        let request = asked.request(Purpose::Run, &self.weighing())?;
        let profile = self::profile(profile, request.volume_ml < 0.0)?;
        let bench = &self.bench;
        let prepared = py.detach(|| bench.prepare_profile(request, &profile));
        let prepared = prepared.map_err(|error| errors::dose(py, error))?;
        Ok(DoseReport::by_profile(bench, &prepared, None).worded(advice::words).json())
    }

    /// Runs a flow over time. Returns the JSON of the command.
    #[pyo3(signature = (asked, profile, progress))]
    fn run_profile(
        &self,
        py: Python<'_>,
        asked: AskedDose<'_>,
        profile: AskedFlow,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<String> {
        let request = asked.request(Purpose::Run, &self.weighing())?;
        let profile = self::profile(profile, request.volume_ml < 0.0)?;
        self.keep_last(None);
        self.warn_before(py, "run")?;
        let ran = self.worker.call(
            py,
            Named::Motion("run"),
            progress,
            |ran: &Ran| {
                self.keep_last(Some(&ran.json));
                ran.note.clone()
            },
            move |held, signal| {
                let bench = held.bench;
                let session = held.session()?;
                // No person watches the runs of a program.
                let is_free = session.state().is_none_or(|state| state.unfinished.is_none());
                if is_free && request.start_angle_rad.is_none() {
                    call_off(session, signal);
                    session.follow_home_policy(|_| signal.flow())?;
                }
                let prepared = session.prepare_profile(request, &profile)?;
                call_off(session, signal);
                signal.plans(prepared.motion().steps().unsigned_abs());
                let delivered = session.run_profile(&prepared, |made| signal.made(made))?;
                signal.ends(delivered.made);
                let report = DoseReport::by_profile(bench, &prepared, Some(&delivered)).worded(advice::words);
                Ok(Ran { json: report.json(), note: note(&delivered), early: None })
            },
        )?;
        self.keep_last(Some(&ran.json));
        Ok(ran.json)
    }
}
