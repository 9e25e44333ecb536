//! Verification: the errors of repeated, weighed doses.

use pump_bench::calibration::{Tolerance, Verification, Weighing};
use pump_bench::units;
use pyo3::prelude::*;

use super::bench::Bench;
use crate::argument::{Argument, optional, quantity};
use crate::python::errors::value;

#[pymethods]
impl Bench {
    /// Returns the errors of weighed doses of the volume `nominal`, as the command's JSON.
    #[pyo3(signature = (nominal, readings, systematic_percent, random_percent))]
    fn verify(
        &self,
        nominal: &Bound<'_, PyAny>,
        readings: &Bound<'_, PyAny>,
        systematic_percent: Argument<'_, '_>,
        random_percent: Argument<'_, '_>,
    ) -> PyResult<String> {
        let weighing = Weighing::of(self.bench.file());
        let nominal = quantity("nominal", "10mL", nominal, units::amount)?;
        let nominal_ml = weighing.amount_ml(nominal).map_err(value)?;
        if !(nominal_ml > 0.0 && nominal_ml.is_finite()) {
            return Err(value(format_args!("nominal is {nominal_ml} mL; allowed: more than 0")));
        }
        let mut volumes_ml = Vec::new();
        for reading in readings.try_iter()? {
            let amount =
                quantity(&format!("readings[{}]", volumes_ml.len()), "9.98g", &reading?, units::amount)?;
            volumes_ml.push(weighing.amount_ml(amount).map_err(value)?);
        }
        let standard = Tolerance::of_standard(nominal_ml);
        let either = |name, given, of: fn(Tolerance) -> f64| {
            let percent = optional(name, given)?.or(standard.map(of)).ok_or_else(|| {
                value(format_args!(
                    "no standard tolerance is known for {nominal_ml} mL (ISO 8655-5 has one for 10 mL); give {name}"
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
