//! An error as one line of JSON, `error/1`.

use serde::Serialize;

use super::explain::ErrorFacts;
use super::kind::ErrorKind;

/// Report of a command that was refused or failed, `error/1`.
///
/// ```
/// use pump_bench::report::{ErrorReport, Explain};
/// use pump_bench::units::time_s;
///
/// let error = time_s("10").unwrap_err();
/// let report = ErrorReport::new(2, &error.facts(), &error.to_string(), false).json();
/// assert!(report.starts_with(r#"{"schema":"error/1","code":2,"kind":"quantity","message":"#));
/// assert!(report.ends_with(r#""value":"10","allowed":"a time with its unit, as 1.5s","moved":false}"#));
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[non_exhaustive]
pub struct ErrorReport<'a> {
    /// Schema of the report, `error/1`.
    pub schema: &'static str,
    /// Exit code of the command.
    pub code: u8,
    /// Kind of the error.
    pub kind: ErrorKind,
    /// Message for people.
    pub message: &'a str,
    /// Value that is wrong, if a single value is.
    pub value: Option<&'a str>,
    /// Values that are allowed, if there is such a range or list.
    pub allowed: Option<&'a str>,
    /// True if the pump may have moved in this command.
    pub moved: bool,
}

impl<'a> ErrorReport<'a> {
    /// Makes the report of an error with the command's exit code.
    pub fn new(code: u8, facts: &'a ErrorFacts, message: &'a str, moved: bool) -> Self {
        Self {
            schema: "error/1",
            code,
            kind: facts.kind,
            message,
            value: facts.value.as_deref(),
            allowed: facts.allowed.as_deref(),
            moved,
        }
    }

    /// Returns the report as JSON, one line without its end.
    pub fn json(&self) -> String {
        serde_json::to_string(self).unwrap_or_else(|error| unreachable!("plain texts and numbers: {error}"))
    }
}
