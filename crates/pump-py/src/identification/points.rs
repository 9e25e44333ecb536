//! Points at which a likelihood is asked: one, or an array of them.

use pump_model::Line;
use pyo3::prelude::*;

use crate::argument::{Argument, Floats};
use crate::python::errors::value;

/// Number of arguments of a likelihood.
pub(super) const ARGUMENTS: usize = 7;
/// Names of these arguments.
pub(super) const NAMES: [&str; ARGUMENTS] = [
    "resistance_kpa_s_ml",
    "compliance_ml_kpa",
    "inertance_kpa_s2_ml",
    "reservoir_kpa",
    "start_angle_rad",
    "start_s",
    "standard_kpa",
];
/// Places of the angle, the start and the noise among them.
const ANGLE: usize = 4;
const START: usize = 5;
const STANDARD: usize = 6;

/// Arguments of a call in one shape, which is none where every argument is one number.
pub(super) struct Points {
    arguments: [Floats; ARGUMENTS],
    shape: Option<Vec<usize>>,
}

impl Points {
    /// Reads the arguments that are given. `own` stand in place of the others.
    pub(super) fn read(
        py: Python<'_>,
        given: [Argument<'_, '_>; ARGUMENTS],
        own: [f64; ARGUMENTS],
    ) -> PyResult<Self> {
        let mut points = NAMES.map(|name| (name, Floats::One(0.0)));
        for (((name, point), given), own) in points.iter_mut().zip(given).zip(own) {
            *point = given.map_or(Ok(Floats::One(own)), |given| Floats::extract(name, given))?;
        }
        for (name, point) in &points[ANGLE..=START] {
            if let Some(number) = point.values().iter().find(|number| !number.is_finite()) {
                return Err(value(format_args!("{name} is {number}; allowed: a finite number")));
            }
        }
        for standard_kpa in points[STANDARD].1.values() {
            positive(*standard_kpa)?;
        }
        let (arguments, shape) = Floats::broadcast(py, points)?;
        Ok(Self { arguments, shape })
    }

    /// Returns the number of points.
    pub(super) fn count(&self) -> usize {
        self.shape.as_ref().map_or(1, |shape| shape.iter().product())
    }

    /// Returns the line, and the angle, the start and the noise, of a point.
    pub(super) fn at(&self, n: usize) -> (Line, [f64; 3]) {
        let [
            resistance_kpa_s_ml,
            compliance_ml_kpa,
            inertance_kpa_s2_ml,
            reservoir_kpa,
            angle,
            start,
            standard,
        ] = self.arguments.each_ref().map(|argument| argument.at(n));
        let line = Line { resistance_kpa_s_ml, compliance_ml_kpa, inertance_kpa_s2_ml, reservoir_kpa };
        (line, [angle, start, standard])
    }

    /// Returns a value for each point in the shape of the arguments.
    pub(super) fn shaped(&self, values: Vec<f64>) -> Floats {
        match (&self.shape, values.as_slice()) {
            (None, [number]) => Floats::One(*number),
            (None, _) => Floats::Many { shape: vec![values.len()], values },
            (Some(shape), _) => Floats::Many { shape: shape.clone(), values },
        }
    }
}

/// Reads the standard deviation of the noise, kPa.
pub(super) fn positive(standard_kpa: f64) -> PyResult<f64> {
    if standard_kpa > 0.0 && standard_kpa.is_finite() {
        return Ok(standard_kpa);
    }
    Err(value(format_args!("standard_kpa is {standard_kpa}; allowed: a positive number")))
}
