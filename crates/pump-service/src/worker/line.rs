//! One line that a process of the command has told.

use serde_json::Value;

/// Line of a process.
#[derive(Debug, Clone, PartialEq)]
pub enum Line {
    /// Progress of a motion, `progress/1`.
    Progress(Value),
    /// A report, as `dose/1`.
    Report(Value),
    /// Words of a report for people.
    Words(String),
    /// Words beside a report, as a warning.
    Message(String),
    /// The reason of a failure, `error/1`.
    Error(Value),
}

impl Line {
    /// Reads a line of standard output: a report or progress in JSON, or else words.
    pub(super) fn of_output(line: &str) -> Self {
        match object(line) {
            Some(value) if has_schema(&value, "progress/1") => Self::Progress(value),
            Some(value) => Self::Report(value),
            None => Self::Words(line.to_owned()),
        }
    }

    /// Reads a line of standard error: words, or a failure in JSON.
    pub(super) fn of_errors(line: &str) -> Self {
        match object(line) {
            Some(value) if has_schema(&value, "error/1") => Self::Error(value),
            _ => Self::Message(line.to_owned()),
        }
    }
}

fn object(line: &str) -> Option<Value> {
    serde_json::from_str(line).ok().filter(Value::is_object)
}

fn has_schema(value: &Value, schema: &str) -> bool {
    value.get("schema").and_then(Value::as_str) == Some(schema)
}
