//! Plain data of Python, its dicts, lists, texts and numbers, as the tables of the libraries.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyString;

use super::readable::readable;

/// Words of the library's types, and those of Python.
const WORDS: [(&str, &str); 8] = [
    ("floating point", "the number"),
    ("integer", "the number"),
    ("string", "the text"),
    ("u32", "a whole number"),
    ("u64", "a whole number"),
    ("i64", "a whole number"),
    ("f64", "a number"),
    ("sequence", "list"),
];

/// Reads the data of `what`, as "a pump", of `most_bytes` as JSON.
///
/// # Errors
///
/// The text of what is wrong, with the keys that lead to it; or the exception of an object that is no plain data.
pub(crate) fn read<T>(
    what: &str,
    data: &Bound<'_, PyAny>,
    most_bytes: u64,
    parse: impl Fn(&str) -> serde_json::Result<T>,
    refused: impl Fn(String) -> PyErr,
) -> PyResult<T> {
    let py = data.py();
    let json = py.import("pumpmodel._results.plain")?.call_method1("json_of", (what, data));
    let json = json.map_err(|error| match error.is_instance_of::<PyValueError>(py) {
        true => refused(error.value(py).to_string()),
        false => error,
    })?;
    let json = json.cast::<PyString>()?.to_str()?;
    if json.len() as u64 > most_bytes {
        let taken = json.len();
        return Err(refused(format!(
            "the data of {what} take {taken} bytes as JSON; allowed: {most_bytes} at most"
        )));
    }
    parse(json).map_err(|error| {
        let told = error.to_string();
        let mut told = told.split(" at line ").next().unwrap_or(&told).to_owned();
        for (word, plain) in WORDS {
            told = told.replace(&format!("{word} "), &format!("{plain} "));
            told = told.replace(&format!("expected {word}"), &format!("expected {plain}"));
        }
        if let Some((before, _)) = told.split_once("expected struct ") {
            told = format!("{before}expected a dict");
        }
        let place = place(json.get(..error.column()).unwrap_or(json));
        let place = if place.is_empty() { place } else { format!("{place}: ") };
        refused(readable(&format!("these are not the data of {what}: {place}{told}")))
    })
}

/// Returns the keys that lead to the end of the begin of a JSON text, as `rollers.count`.
fn place(begin: &str) -> String {
    let mut keys: Vec<Option<String>> = Vec::new();
    let (mut text, mut in_text, mut is_escaped) = (String::new(), false, false);
    for c in begin.chars() {
        match (in_text, is_escaped, c) {
            (true, false, '\\') => is_escaped = true,
            (true, false, '"') => in_text = false,
            (true, ..) => {
                is_escaped = false;
                text.push(c);
            }
            (false, _, '"') => {
                in_text = true;
                text.clear();
            }
            (false, _, '{' | '[') => keys.push(None),
            (false, _, '}' | ']') if keys.len() > 1 => drop(keys.pop()),
            (false, _, ':') => {
                if let Some(key) = keys.last_mut() {
                    *key = Some(std::mem::take(&mut text));
                }
            }
            (false, _, ',') => {
                if let Some(key) = keys.last_mut() {
                    *key = None;
                }
            }
            _ => {}
        }
    }
    keys.into_iter().flatten().collect::<Vec<_>>().join(".")
}
