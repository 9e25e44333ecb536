//! The log of a bench.

use pump_bench::record::{Clock, LogLine, SystemClock, moment};
use pump_bench::report::{LogPlace, LogSpan, log_json, with_sources};
use pyo3::prelude::*;

use super::bench::Bench;
use crate::python::append;
use crate::python::errors::{PumpError, value};
use crate::python::warnings::warn;

#[pymethods]
impl Bench {
    /// Reads the log. Returns the JSON of each dose that began at `since` or later.
    fn log(&self, py: Python<'_>, since: Option<&str>) -> PyResult<Vec<String>> {
        let now = SystemClock::default().now();
        let since = since.map(|text| moment(text, now)).transpose();
        let since = since.map_err(|error| value(format_args!("since: {error}")))?;
        let bench = &self.bench;
        let mut span = LogSpan::new(since.unwrap_or(0), u64::MAX, now.unix_s);
        let read = || -> PyResult<(Vec<String>, Vec<String>)> {
            let lines = bench.log().map_err(|error| PumpError::new_err(with_sources(&error)))?;
            let (mut doses, mut warnings) = (Vec::new(), Vec::new());
            for line in lines {
                match line.map_err(|error| PumpError::new_err(with_sources(&error)))? {
                    LogLine::Dose(entry) => {
                        let LogPlace { is_within, went_back, .. } = span.look(&entry);
                        if is_within {
                            let (pump, driver) = (&bench.file().pump.id, bench.drive_id());
                            append(&mut doses, log_json(pump, driver, &entry, went_back))?;
                        }
                    }
                    LogLine::Damaged { line, message } => {
                        let said = format!("line {line} of the log is damaged and left out: {message}");
                        append(&mut warnings, said)?;
                    }
                    _ => {}
                }
            }
            warnings.extend(span.left_out().map(|left_out| left_out.told("since")));
            Ok((doses, warnings))
        };
        let (doses, warnings) = py.detach(read)?;
        warn(py, &warnings)?;
        Ok(doses)
    }
}
