//! Repeated doses: when each of a batch is due, and what weighed ones show.

use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use pump_bench::calibration::{Tolerance, Verification, Weighing};
use pump_bench::dosing::{Action, Missed, Schedule as DoseSchedule};
use pump_bench::units;
use pump_bench::units::Amount;
use pyo3::prelude::*;

use crate::bench::Bench;
use crate::doser::text;
use crate::errors::value;
use crate::pump::one_of;

#[pymethods]
impl Bench {
    /// Errors of doses that should be `nominal`, as the command's JSON.
    #[pyo3(signature = (nominal, readings, systematic_percent, random_percent))]
    fn verify(
        &self,
        nominal: &Bound<'_, PyAny>,
        readings: &Bound<'_, PyAny>,
        systematic_percent: Option<f64>,
        random_percent: Option<f64>,
    ) -> PyResult<String> {
        let weighing = Weighing::of(self.bench.file());
        let degc = weighing.fluid.temperature_degc;
        let nominal = units::amount(text("nominal", "10mL", nominal)?).map_err(value)?;
        let nominal_ml = nominal.volume_ml(self.bench.file().fluid.density_kg_m3);
        if !(nominal_ml > 0.0 && nominal_ml.is_finite()) {
            return Err(value(format_args!("nominal is {nominal_ml} mL; allowed: more than 0")));
        }
        let mut volumes_ml = Vec::new();
        for reading in readings.try_iter()? {
            let amount = units::amount(text("a reading", "9.98g", &reading?)?).map_err(value)?;
            volumes_ml.push(match amount {
                Amount::Mass(mass_g) => weighing.volume_ml(mass_g, degc).map_err(value)?,
                Amount::Volume(volume_ml) => volume_ml,
            });
        }
        let standard = Tolerance::of_standard(nominal_ml);
        let either = |name, given: Option<f64>, of: fn(Tolerance) -> f64| {
            let percent = given.or(standard.map(of)).ok_or_else(|| {
                value(format_args!(
                    "for {nominal_ml} mL no standard's tolerance is known here (ISO 8655-5's is for 10 mL); give {name}"
                ))
            })?;
            if percent > 0.0 && percent <= 100.0 {
                Ok(percent)
            } else {
                Err(value(format_args!("{name} is {percent}; allowed: more than 0, 100 at most")))
            }
        };
        let tolerance = Tolerance {
            systematic_percent: either("systematic_percent", systematic_percent, |of| of.systematic_percent)?,
            random_percent: either("random_percent", random_percent, |of| of.random_percent)?,
        };
        Ok(Verification::of(nominal_ml, volumes_ml, tolerance).map_err(value)?.json())
    }
}

/// When each dose of a batch is due.
#[pyclass(frozen, name = "_Schedule", module = "pumpmodel._pumpmodel")]
pub(crate) struct Schedule(Mutex<DoseSchedule>);

#[pymethods]
impl Schedule {
    #[new]
    fn new(count: u64, every_s: Option<f64>, missed: &str) -> PyResult<Self> {
        one_of("missed", missed, &["skip", "now"])?;
        let missed = if missed == "now" { Missed::Now } else { Missed::Skip };
        Ok(Self(Mutex::new(DoseSchedule::new(count, every_s, missed).map_err(value)?)))
    }

    /// What to do `elapsed_s` after the batch's start: "wait" until a time, s; "dose" or "skip" a number; or "done".
    fn next(&self, elapsed_s: f64) -> PyResult<(&'static str, f64)> {
        let elapsed = Duration::try_from_secs_f64(elapsed_s).map_err(value)?;
        let mut schedule = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        Ok(match schedule.next(elapsed) {
            Action::Wait(until) => ("wait", until.as_secs_f64()),
            Action::Dose(number) => ("dose", number as f64),
            Action::Skip(number) => ("skip", number as f64),
            Action::Done => ("done", 0.0),
        })
    }
}
