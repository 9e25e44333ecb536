//! The log of a bench.

use pump_bench::record::{Clock, LogLine, SystemClock, moment};
use pump_bench::report::{log_json, with_sources};
use pyo3::prelude::*;

use super::bench::Bench;
use crate::python::errors::{PumpError, value};

#[pymethods]
impl Bench {
    /// Reads the log. Returns the JSON of each dose that began at `since` or later.
    fn log(&self, py: Python<'_>, since: Option<&str>) -> PyResult<Vec<String>> {
        let since =
            since.map(|text| moment(text, SystemClock::default().now())).transpose().map_err(value)?;
        let (bench, since) = (&self.bench, since.unwrap_or(0));
        let read = || -> Result<Vec<String>, String> {
            let lines = bench.log().map_err(|error| with_sources(&error))?;
            let (mut doses, mut before_s) = (Vec::new(), 0);
            for line in lines {
                if let LogLine::Dose(entry) = line.map_err(|error| with_sources(&error))? {
                    let unix_s = entry.time.unix_s;
                    let went_back = unix_s < std::mem::replace(&mut before_s, unix_s);
                    if unix_s >= since {
                        let (pump, driver) = (&bench.file().pump.id, bench.drive_id());
                        doses.push(log_json(pump, driver, &entry, went_back));
                    }
                }
            }
            Ok(doses)
        };
        py.detach(read).map_err(PumpError::new_err)
    }
}
