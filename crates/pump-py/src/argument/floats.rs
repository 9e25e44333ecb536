//! Numbers that come alone or as an array of any shape, and return in that shape.

use numpy::ndarray::IxDyn;
use numpy::{PyArray1, PyArrayDyn, PyArrayMethods};
use pyo3::IntoPyObjectExt;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyList, PyString, PyTuple};

use super::number::{in_unit, number};
use super::object::told_of;
use crate::python::errors::value;
use crate::python::spare::refill;
use crate::python::{SignalCheck, collected, reserve};

/// Number of values that are looked at between two checks for signals: a few milliseconds.
const CHUNK: usize = 1 << 20;

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
        for values in floats.values().chunks(CHUNK) {
            argument.py().check_signals()?;
            if let Some(number) = values.iter().find(|number| !(-limit..=limit).contains(*number)) {
                return Err(value(format_args!(
                    "{name} is {number}; allowed: a finite number, up to {limit:e} either way"
                )));
            }
        }
        Ok(floats)
    }

    /// Reads the argument `name` without a check of its range.
    pub(crate) fn extract(name: &str, argument: &Bound<'_, PyAny>) -> PyResult<Self> {
        if let Ok(number) = argument.cast::<PyFloat>() {
            return Ok(Self::One(number.value()));
        }
        let py = argument.py();
        refill()?;
        refuse_masked(name, argument)?;
        let array = py.import(intern!(py, "numpy"))?.call_method1(intern!(py, "asarray"), (argument,));
        let array = array.map_err(|error| match error.is_instance_of::<PyValueError>(py) {
            true => value(format_args!(
                "{name} is no array of numbers{}: its parts differ in shape; allowed: a number, or \
                 numbers in one shape",
                in_unit(name)
            )),
            false => error,
        })?;
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
            if kind == "O"
                && let Some(floats) = Self::of_objects(name, argument, &array)?
            {
                return Ok(floats);
            }
            return Err(no_numbers(name, argument, &array)?);
        }
        // In C order, and no copy of what is such an array already. A part of a buffer may stand at any address.
        let is_aligned: bool =
            array.getattr(intern!(py, "flags"))?.getattr(intern!(py, "aligned"))?.extract()?;
        let keywords = PyDict::new(py);
        keywords.set_item(intern!(py, "order"), intern!(py, "C"))?;
        keywords.set_item(intern!(py, "copy"), !is_aligned)?;
        let array = array.call_method(intern!(py, "astype"), (intern!(py, "float64"),), Some(&keywords))?;
        let array = array.cast::<PyArrayDyn<f64>>()?.try_readonly()?;
        let given = array.as_slice()?;
        let mut values = Vec::new();
        reserve(&mut values, given.len() as u64)?;
        for part in given.chunks(CHUNK) {
            py.check_signals()?;
            values.extend_from_slice(part);
        }
        let array = array.as_array();
        Ok(match (array.shape(), values.as_slice()) {
            ([], [number]) => Self::One(*number),
            (shape, _) => Self::Many { shape: shape.to_vec(), values },
        })
    }

    /// Reads an array of objects that each become a float, as whole numbers beyond 64 bits and those of `decimal` and
    /// `fractions`. Returns none if something else is among them.
    fn of_objects(
        name: &str,
        argument: &Bound<'_, PyAny>,
        array: &Bound<'_, PyAny>,
    ) -> PyResult<Option<Self>> {
        let py = argument.py();
        let shape: Vec<usize> = array.getattr(intern!(py, "shape"))?.extract()?;
        if shape.is_empty() {
            let is_number = argument.hasattr("__float__")? || argument.hasattr("__index__")?;
            return is_number.then(|| number(name, argument).map(Self::One)).transpose();
        }
        let mut values = Vec::new();
        reserve(&mut values, array.getattr(intern!(py, "size"))?.extract()?)?;
        for item in array.getattr(intern!(py, "flat"))?.try_iter()? {
            let item = item?;
            if item.is_instance_of::<PyBool>() || !item.hasattr("__float__")? {
                return Ok(None);
            }
            values.push(number(name, &item)?);
        }
        Ok(Some(Self::Many { shape, values }))
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

    /// Applies `f` to every number, while other Python threads run and signals interrupt.
    pub(crate) fn map(&self, py: Python<'_>, f: impl Fn(f64) -> f64 + Sync) -> PyResult<Self> {
        let values = match self {
            Self::One(number) => return Ok(Self::One(f(*number))),
            Self::Many { values, .. } => values,
        };
        Ok(self.with_values(SignalCheck::quick(py, values.len(), |n| Ok(f(values[n])))?))
    }

    /// Brings arguments to one shape as NumPy does, and returns that shape. A single number stays one, and the shape is
    /// none if every argument is.
    pub(crate) fn broadcast<const N: usize>(
        py: Python<'_>,
        named: [(&str, Self); N],
    ) -> PyResult<([Self; N], Option<Vec<usize>>)> {
        let many = |(_, floats): &&(&str, Self)| matches!(floats, Self::Many { .. });
        let shapes = || named.iter().filter(many).map(|(_, floats)| floats.shape());
        let Some(first) = shapes().next() else {
            return Ok((named.map(|(_, floats)| floats), None));
        };
        if shapes().all(|shape| shape == first) {
            let first = first.to_vec();
            return Ok((named.map(|(_, floats)| floats), Some(first)));
        }
        let numpy = py.import(intern!(py, "numpy"))?;
        let shapes =
            PyTuple::new(py, shapes().map(|shape| PyTuple::new(py, shape)).collect::<PyResult<Vec<_>>>()?)?;
        let shape = numpy.call_method1(intern!(py, "broadcast_shapes"), &shapes).map_err(|_| {
            let given =
                named.iter().filter(many).map(|(name, floats)| format!("{name} {:?}", floats.shape()));
            let given = given.collect::<Vec<_>>().join(", ");
            value(format_args!(
                "these shapes do not fit together: {given}; allowed: equal shapes, or one number"
            ))
        })?;
        let mut all = Vec::new();
        for (name, floats) in named {
            all.push(match floats {
                Self::One(number) => Self::One(number),
                many @ Self::Many { .. } => {
                    let array = many.into_object(py)?;
                    let array = numpy.call_method1(intern!(py, "broadcast_to"), (array, &shape))?;
                    Self::extract(name, &array)?
                }
            });
        }
        let all = <[Self; N]>::try_from(all).map_err(|_| value("an argument was lost"))?;
        Ok((all, Some(shape.extract()?)))
    }

    /// Returns the number at a place in C order, of which a single number has every one.
    pub(crate) fn at(&self, n: usize) -> f64 {
        match self {
            Self::One(number) => *number,
            Self::Many { values, .. } => values[n],
        }
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

/// Returns the error of an array that is none of numbers: with its first text, or what else it is.
fn no_numbers(name: &str, argument: &Bound<'_, PyAny>, array: &Bound<'_, PyAny>) -> PyResult<PyErr> {
    let py = argument.py();
    let must = format!("{name} must be a number or an array of numbers{}", in_unit(name));
    let told = told_of(argument)?;
    if array.getattr(intern!(py, "ndim"))?.extract::<usize>()? == 0 {
        return Ok(PyTypeError::new_err(format!("{must}, not {told}")));
    }
    let mut are_texts = false;
    for (n, item) in array.getattr(intern!(py, "flat"))?.try_iter()?.enumerate() {
        let item = item?;
        let Ok(text) = item.cast::<PyString>() else {
            if item.extract::<f64>().is_ok() {
                continue;
            }
            let place = format!("{told} with {} at place {n}", told_of(&item)?);
            return Ok(PyTypeError::new_err(format!("{must}, not {place}")));
        };
        if text.to_str()?.trim().parse::<f64>().is_ok() {
            are_texts = true;
            continue;
        }
        let place = format!("{told} with {} at place {n}, which is no number", told_of(&item)?);
        return Ok(PyTypeError::new_err(format!(
            "{must}, not {place}; correct or leave out what is no number"
        )));
    }
    let kind = array.getattr(intern!(py, "dtype"))?;
    Ok(PyTypeError::new_err(match are_texts {
        true => format!(
            "{must}, not {told} of texts; turn them into numbers, as by numpy.asarray({name}, dtype=float)"
        ),
        false => format!("{must}, not {told} of the dtype {kind}"),
    }))
}

/// Refuses an array of `numpy.ma` with masked numbers, which NumPy would read as if they were not masked.
fn refuse_masked(name: &str, argument: &Bound<'_, PyAny>) -> PyResult<()> {
    let py = argument.py();
    // Where nobody has loaded `numpy.ma`, nobody has such an array.
    let modules = py.import(intern!(py, "sys"))?.getattr(intern!(py, "modules"))?;
    let ma = modules.call_method1(intern!(py, "get"), (intern!(py, "numpy.ma"),))?;
    if ma.is_none() {
        return Ok(());
    }
    // Another thread that still loads it has none either.
    let Some(masked_array) = ma.getattr_opt(intern!(py, "MaskedArray"))? else { return Ok(()) };
    if !argument.is_instance(&masked_array)? {
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
