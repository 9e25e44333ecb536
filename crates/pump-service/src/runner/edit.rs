//! Edits of the schedule's file. Everything else stays as it was written, comments and order too.

use serde_json::{Map, Value as Json};
use toml_edit::{ArrayOfTables, DocumentMut, InlineTable, Item, Table, Value};

use super::refusal::EditError;
use crate::schedule::Entry;

/// Keys of an entry as JSON.
pub(super) type Keys = Map<String, Json>;

/// Returns the text with one more entry, the last.
pub(super) fn added(text: &str, keys: &Keys) -> Result<String, EditError> {
    let mut file = document(text)?;
    let entries = file.entry("entry").or_insert_with(|| Item::ArrayOfTables(ArrayOfTables::new()));
    let entries = entries.as_array_of_tables_mut().ok_or(EditError::Inline)?;
    let mut table = Table::new();
    table.decor_mut().set_prefix("\n");
    for (key, value) in in_order(keys) {
        table.insert(key, Item::Value(toml(key, value)?));
    }
    entries.push(table);
    Ok(file.to_string())
}

/// Returns the text with these keys of the entry at `index` set, and others taken out. A comment beside a value stays.
pub(super) fn changed(
    text: &str,
    index: usize,
    set: &Keys,
    takes_out: impl Fn(&str) -> bool,
) -> Result<String, EditError> {
    let mut file = document(text)?;
    let table = entries(&mut file)?.get_mut(index).ok_or(EditError::Inline)?;
    let known: Vec<String> = table.iter().map(|(key, _)| key.to_owned()).collect();
    for key in known.iter().filter(|key| takes_out(key)) {
        table.remove(key);
    }
    for (key, value) in in_order(set) {
        let mut value = toml(key, value)?;
        match table.get_mut(key) {
            Some(Item::Value(old)) => {
                *value.decor_mut() = old.decor().clone();
                *old = value;
            }
            Some(other) => *other = Item::Value(value),
            None => drop(table.insert(key, Item::Value(value))),
        }
    }
    Ok(file.to_string())
}

/// Returns the text without the entry at `index`, and without the comment above it.
pub(super) fn removed(text: &str, index: usize) -> Result<String, EditError> {
    let mut file = document(text)?;
    let entries = entries(&mut file)?;
    if index >= entries.len() {
        return Err(EditError::Inline);
    }
    entries.remove(index);
    Ok(file.to_string())
}

fn document(text: &str) -> Result<DocumentMut, EditError> {
    text.parse().map_err(|error: toml_edit::TomlError| EditError::Syntax(error.to_string()))
}

fn entries(file: &mut DocumentMut) -> Result<&mut ArrayOfTables, EditError> {
    file.get_mut("entry").and_then(Item::as_array_of_tables_mut).ok_or(EditError::Inline)
}

/// The keys in the order in which a person writes them. Unknown ones come last, and are refused by their names.
fn in_order(keys: &Keys) -> impl Iterator<Item = (&String, &Json)> {
    let known = Entry::KEYS.iter().filter_map(|key| keys.get_key_value(*key));
    known.chain(keys.iter().filter(|(key, _)| !Entry::KEYS.contains(&key.as_str())))
}

/// A value of JSON as TOML has it.
fn toml(key: &str, value: &Json) -> Result<Value, EditError> {
    Ok(match value {
        Json::Null => return Err(EditError::Null(key.to_owned())),
        Json::Bool(on) => (*on).into(),
        Json::Number(number) => match number.as_i64() {
            Some(whole) => whole.into(),
            None => number.as_f64().unwrap_or(f64::NAN).into(),
        },
        Json::String(text) => text.as_str().into(),
        Json::Array(list) => list.iter().map(|value| toml(key, value)).collect::<Result<Value, _>>()?,
        Json::Object(table) => {
            let mut inline = InlineTable::new();
            for (key, value) in table {
                inline.insert(key, toml(key, value)?);
            }
            inline.into()
        }
    })
}
