//! Columns of measurements.

use pump_model::Shown;
use pyo3::prelude::*;

use crate::argument::Floats;
use crate::python::errors::value;

/// Reads finite numbers of shape (n,). With `count`, n must equal the length of the columns before.
pub(super) fn column(name: &str, argument: &Bound<'_, PyAny>, count: Option<usize>) -> PyResult<Vec<f64>> {
    let (shape, values) = match Floats::extract(name, argument)? {
        Floats::Many { shape, values } => (shape, values),
        Floats::One(_) => (Vec::new(), Vec::new()),
    };
    if shape.len() != 1 || count.is_some_and(|count| shape[0] != count) {
        let allowed = count.map_or("(n,)".to_owned(), |count| format!("({count},)"));
        return Err(value(format_args!("{name} has shape {shape:?}; allowed: {allowed}")));
    }
    if let Some((n, number)) = values.iter().enumerate().find(|(_, number)| !number.is_finite()) {
        return Err(value(format_args!("{name}[{n}] is {}; allowed: a finite number", Shown(*number))));
    }
    Ok(values)
}
