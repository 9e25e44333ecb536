//! Numbers that come alone or as an array of any shape, and return in that shape.

use numpy::ndarray::IxDyn;
use numpy::{PyArray1, PyArrayDyn, PyArrayMethods};
use pyo3::IntoPyObjectExt;
use pyo3::exceptions::PyTypeError;
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyFloat, PyList, PyTuple};

use crate::python::errors::value;
use crate::python::{collected, try_collected};

/// One number, or many with their shape in C order.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Floats {
    One(f64),
    Many { shape: Vec<usize>, values: Vec<f64> },
}

impl Floats {
    /// Reads the argument `name`: a float, or anything that NumPy turns into an array of integers or floats. Every
    /// number must be finite and within `limit` either way.
    pub(crate) fn read(name: &str, argument: &Bound<'_, PyAny>, limit: f64) -> PyResult<Self> {
        let floats = Self::extract(name, argument)?;
        match floats.values().iter().find(|number| !(-limit..=limit).contains(*number)) {
            None => Ok(floats),
            Some(number) => Err(value(format_args!(
                "{name} is {number}; allowed: a finite number, up to {limit:e} either way"
            ))),
        }
    }

    /// Reads the argument `name` without a check of its range.
    pub(crate) fn extract(name: &str, argument: &Bound<'_, PyAny>) -> PyResult<Self> {
        if let Ok(number) = argument.cast::<PyFloat>() {
            return Ok(Self::One(number.extract()?));
        }
        let py = argument.py();
        refuse_masked(name, argument)?;
        let array = py.import(intern!(py, "numpy"))?.call_method1(intern!(py, "asarray"), (argument,))?;
        if array.getattr(intern!(py, "ndim"))?.extract::<usize>()? > 1 {
            // An array of several arrays would forget their masks.
            if let Ok(list) = argument.cast::<PyList>() {
                list.iter().try_for_each(|part| refuse_masked(name, &part))?;
            } else if let Ok(tuple) = argument.cast::<PyTuple>() {
                tuple.iter().try_for_each(|part| refuse_masked(name, &part))?;
            }
        }
        // NumPy would read the text "100" as 100.0.
        let kind: String = array.getattr(intern!(py, "dtype"))?.getattr(intern!(py, "kind"))?.extract()?;
        if !matches!(kind.as_str(), "f" | "i" | "u") {
            return Err(PyTypeError::new_err(format!(
                "{name} must be a number or an array of numbers, not {}",
                argument.get_type().name()?
            )));
        }
        let array = array.call_method1(intern!(py, "astype"), (intern!(py, "float64"),))?;
        let array = array.cast::<PyArrayDyn<f64>>()?.try_readonly()?;
        let array = array.as_array();
        let values = collected(array.iter().copied())?;
        Ok(match (array.shape(), values.as_slice()) {
            ([], [number]) => Self::One(*number),
            (shape, _) => Self::Many { shape: shape.to_vec(), values },
        })
    }

    /// Returns the numbers in C order.
    pub(crate) fn values(&self) -> &[f64] {
        match self {
            Self::One(number) => std::slice::from_ref(number),
            Self::Many { values, .. } => values,
        }
    }

    /// Returns the numbers in C order, without a copy.
    pub(crate) fn into_values(self) -> PyResult<Vec<f64>> {
        match self {
            Self::One(number) => collected([number]),
            Self::Many { values, .. } => Ok(values),
        }
    }

    /// Returns the lengths of the axes; a single number has none.
    pub(crate) fn shape(&self) -> &[usize] {
        match self {
            Self::One(_) => &[],
            Self::Many { shape, .. } => shape,
        }
    }

    /// Returns other values in this shape, as many as there are.
    pub(crate) fn with_values(&self, values: Vec<f64>) -> Self {
        match (self, values.as_slice()) {
            (Self::One(_), [number]) => Self::One(*number),
            (Self::One(_), _) => Self::Many { shape: vec![values.len()], values },
            (Self::Many { shape, .. }, _) => Self::Many { shape: shape.clone(), values },
        }
    }

    /// Applies `f` to every number.
    pub(crate) fn map(&self, f: impl Fn(f64) -> f64) -> PyResult<Self> {
        match self {
            Self::One(number) => Ok(Self::One(f(*number))),
            Self::Many { values, .. } => {
                Ok(self.with_values(collected(values.iter().map(|number| f(*number)))?))
            }
        }
    }

    /// Applies `f` to every number, up to the first error.
    pub(crate) fn try_map(&self, f: impl FnMut(f64) -> PyResult<f64>) -> PyResult<Self> {
        Ok(self.with_values(try_collected(self.values().iter().copied().map(f))?))
    }

    /// Brings both to one shape as NumPy does. A single number stays one.
    pub(crate) fn broadcast(py: Python<'_>, one: Self, other: Self) -> PyResult<(Self, Self)> {
        if matches!((&one, &other), (Self::One(_), _) | (_, Self::One(_))) || one.shape() == other.shape() {
            return Ok((one, other));
        }
        let arrays = (one.into_object(py)?, other.into_object(py)?);
        let arrays =
            py.import(intern!(py, "numpy"))?.call_method1(intern!(py, "broadcast_arrays"), arrays)?;
        let (one, other): (Bound<'_, PyAny>, Bound<'_, PyAny>) = arrays.extract()?;
        Ok((Self::extract("one", &one)?, Self::extract("other", &other)?))
    }

    /// Converts to a Python float, or to an array of float64.
    pub(crate) fn into_object(self, py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
        match self {
            Self::One(number) => number.into_bound_py_any(py),
            Self::Many { shape, values } => {
                Ok(PyArray1::from_vec(py, values).reshape(IxDyn(&shape))?.into_any())
            }
        }
    }

    /// Converts to a Python float, or to a read-only array of float64.
    pub(crate) fn into_frozen(self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        let object = self.into_object(py)?;
        if let Ok(array) = object.cast::<PyArrayDyn<f64>>() {
            array.try_readwrite()?.make_nonwriteable();
        }
        Ok(object.unbind())
    }
}

/// Refuses an array of `numpy.ma` with masked numbers, which NumPy would read as if they were not masked.
fn refuse_masked(name: &str, argument: &Bound<'_, PyAny>) -> PyResult<()> {
    let py = argument.py();
    let ma = py.import(intern!(py, "numpy.ma"))?;
    if !argument.is_instance(&ma.getattr(intern!(py, "MaskedArray"))?)? {
        return Ok(());
    }
    let masked: usize = ma.call_method1(intern!(py, "count_masked"), (argument,))?.extract()?;
    if masked == 0 {
        return Ok(());
    }
    Err(value(format_args!(
        "{name} has {masked} masked numbers; allowed: none; leave them out, as with .compressed(), or fill them, as \
         with .filled()"
    )))
}

/// Returns the numbers that NumPy makes of an argument: a float, or an array of float64 of its shape.
#[pyfunction]
pub(crate) fn _numbers<'py>(name: &str, argument: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    Floats::extract(name, argument)?.into_object(argument.py())
}
