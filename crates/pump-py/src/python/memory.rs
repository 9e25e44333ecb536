//! Memory that grows with what Python passes: reserved before it is used.
//!
//! An allocation that fails inside of `collect`, `to_vec` or `push` ends the process, and with it a bench that moves a
//! motor. Whatever grows with an input, or with the length of a result, therefore goes through this file.

use pyo3::exceptions::PyMemoryError;
use pyo3::prelude::*;

/// Reserves room for `count` more items. Too many raise a `MemoryError`.
pub(crate) fn reserve<T>(items: &mut Vec<T>, count: u64) -> PyResult<()> {
    usize::try_from(count)
        .ok()
        .and_then(|count| items.try_reserve_exact(count).ok())
        .ok_or_else(|| no_memory(count))
}

/// Collects items in room that is reserved for all of them at once.
pub(crate) fn collected<T>(
    items: impl IntoIterator<IntoIter: ExactSizeIterator<Item = T>>,
) -> PyResult<Vec<T>> {
    let items = items.into_iter();
    let mut all = Vec::new();
    reserve(&mut all, items.len() as u64)?;
    all.extend(items);
    Ok(all)
}

/// Collects items as [`collected`] does, up to the first error.
pub(crate) fn try_collected<T>(
    items: impl IntoIterator<IntoIter: ExactSizeIterator<Item = PyResult<T>>>,
) -> PyResult<Vec<T>> {
    let items = items.into_iter();
    let mut all = Vec::new();
    reserve(&mut all, items.len() as u64)?;
    for item in items {
        all.push(item?);
    }
    Ok(all)
}

/// Appends an item to a list whose length nobody knows before.
pub(crate) fn append<T>(items: &mut Vec<T>, item: T) -> PyResult<()> {
    items.try_reserve(1).map_err(|_| no_memory(items.len() as u64 + 1))?;
    items.push(item);
    Ok(())
}

/// Returns the `MemoryError` of a list of `count` items.
pub(crate) fn no_memory(count: u64) -> PyErr {
    PyMemoryError::new_err(format!("no memory for {count} items"))
}
