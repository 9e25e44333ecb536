//! A bench's rotor, tube and unfinished dose: the entries that a person makes in the record.

use std::sync::Arc;

use pump_bench::report::Status;
use pump_bench::{DoseError, Session};
use pump_ctl::plan::Phase;
use pump_model::units::rad_s;
use pyo3::prelude::*;

use super::bench::{Bench, call_off};
use super::worker::{Held, Named, Signal};
use crate::argument::{Argument, number, optional};
use crate::python::advice;
use crate::python::errors::value;

/// Speed at which a rotor is turned to its mark, r/min, as by the command.
const JOG_RPM: f64 = 10.0;

/// Largest angle by which a rotor is turned at once, rad.
const MOST_JOG_RAD: f64 = 100.0;

/// Status of the record after a change, as JSON, and warnings for a person.
pub(super) type Told = (String, Vec<String>);

#[pymethods]
impl Bench {
    /// Records the angle of the rotor; None records that it is unknown. A damaged journal is moved aside.
    #[pyo3(signature = (angle_rad, half_width_rad))]
    fn home_set(
        &self,
        py: Python<'_>,
        angle_rad: Argument<'_, '_>,
        half_width_rad: &Bound<'_, PyAny>,
    ) -> PyResult<Told> {
        let angle_rad = optional("angle_rad", angle_rad)?;
        if let Some(angle) = angle_rad.filter(|angle| !angle.is_finite()) {
            return Err(value(format_args!("angle_rad is {angle}; allowed: a finite angle")));
        }
        let half_width_rad = width(half_width_rad)?;
        let phase = angle_rad.map(|angle_rad| Phase::within(angle_rad, half_width_rad));
        self.tell(py, Named::Entry("home_set"), move |held, _| {
            let mut told = Vec::new();
            let carry_ml = if let Some(session) = &mut held.session {
                let carry_ml = session.owed_ml();
                session.set_angle(phase)?;
                carry_ml
            } else {
                let (session, set) = held.bench.set_angle(phase)?;
                held.session = Some(session);
                told.extend(set.aside.map(|aside| format!("the damaged journal is now {}", aside.display())));
                set.owed_ml
            };
            told.extend(forgotten(carry_ml));
            Ok(told)
        })
    }

    /// Turns forward until the index sensor answers. A stop before that is a warning.
    fn home_sensor(&self, py: Python<'_>) -> PyResult<Told> {
        self.tell(py, Named::Motion("home_sensor"), |held, signal| {
            let session = held.session()?;
            let carry_ml = session.owed_ml();
            call_off(session, signal);
            let found = session.seek_index(|made| signal.made(made))?;
            Ok(match found {
                Some(_) => forgotten(carry_ml),
                None => {
                    vec!["stopped before the sensor answered; the record has the rotor's angle".to_owned()]
                }
            })
        })
    }

    /// Turns the rotor by about this angle, rad. Returns the angle of the steps made, rad.
    fn jog(&self, py: Python<'_>, angle_rad: &Bound<'_, PyAny>) -> PyResult<f64> {
        let angle_rad = number("angle_rad", angle_rad)?;
        if !(angle_rad.abs() <= MOST_JOG_RAD && angle_rad != 0.0) {
            return Err(value(format_args!(
                "angle_rad is {angle_rad}; allowed: up to {MOST_JOG_RAD} either way, and not 0"
            )));
        }
        self.worker.call(
            py,
            Named::Motion("jog_rad"),
            None,
            |_| "the turn is on record".to_owned(),
            move |held, signal| {
                let step_rad = held.bench.file().limits().motor.step_rad();
                let session = held.session()?;
                let steps = session.steps_of(angle_rad);
                call_off(session, signal);
                let made = session.jog(steps, rad_s(JOG_RPM), |made| signal.made(made))?;
                Ok(made as f64 * steps.signum() as f64 * step_rad)
            },
        )
    }

    /// Records that the rotor's mark meets the housing's.
    fn home_mark(&self, py: Python<'_>, half_width_rad: &Bound<'_, PyAny>) -> PyResult<Told> {
        let half_width_rad = width(half_width_rad)?;
        self.tell(py, Named::Entry("home_mark"), move |held, _| {
            let session = held.session()?;
            let carry_ml = session.owed_ml();
            session.set_at_mark(half_width_rad)?;
            Ok(forgotten(carry_ml))
        })
    }

    /// Accepts the unfinished dose with the volume that was delivered.
    fn discard(&self, py: Python<'_>) -> PyResult<Told> {
        self.tell(py, Named::Entry("discard"), |held, _| {
            let session = held.session()?;
            let carry_ml = session.owed_ml();
            let (_, unasked) = session.discard()?;
            let unasked = unasked
                .map(|error| format!("the device's step count could not be read: {}", advice::told(&error)));
            Ok(unasked.into_iter().chain(forgotten(carry_ml)).collect())
        })
    }

    /// Releases the rotor: the motor holds it no longer.
    fn release(&self, py: Python<'_>) -> PyResult<Told> {
        self.tell(py, Named::Entry("release"), |held, _| held.session()?.release().map(|_| Vec::new()))
    }

    /// Records that the tube is new.
    fn new_tube(&self, py: Python<'_>) -> PyResult<Told> {
        self.tell(py, Named::Entry("new_tube"), |held, _| {
            let new = held.session()?.new_tube()?;
            let unused = new.unused.map(|version| {
                format!(
                    "calibration {version} is no longer used; bench.use_calibration({version}) uses it again"
                )
            });
            Ok(forgotten(new.owed_ml).into_iter().chain(unused).collect())
        })
    }
}

impl Bench {
    /// Does `job` and reads the status afterwards.
    pub(super) fn tell(
        &self,
        py: Python<'_>,
        name: Named,
        job: impl FnOnce(&mut Held<'_>, &Arc<Signal>) -> Result<Vec<String>, DoseError> + Send + 'static,
    ) -> PyResult<Told> {
        self.worker.call(
            py,
            name,
            None,
            |_| "the call was completed and is on record".to_owned(),
            move |held, signal| {
                let mut told = job(held, signal)?;
                let notes = held.session.as_mut().map_or_else(Vec::new, Session::notes);
                told.splice(0..0, advice::worded(&notes));
                Ok((Status::of(held.bench)?.json(), told))
            },
        )
    }
}

/// Returns the warning that a carry is forgotten, if there was one.
fn forgotten(carry_ml: f64) -> Vec<String> {
    let warning = (carry_ml != 0.0).then(|| format!("the carry of {:.2} µL is forgotten", 1e3 * carry_ml));
    warning.into_iter().collect()
}

/// Checks the half width of an angle, rad.
fn width(half_width_rad: &Bound<'_, PyAny>) -> PyResult<f64> {
    let half_width_rad = number("half_width_rad", half_width_rad)?;
    if half_width_rad >= 0.0 && half_width_rad.is_finite() {
        Ok(half_width_rad)
    } else {
        Err(value(format_args!("half_width_rad is {half_width_rad}; allowed: a finite angle, 0 or more")))
    }
}
