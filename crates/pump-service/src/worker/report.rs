//! Failures as `error/1`.

use std::process::ExitStatus;

use serde_json::{Value, json};

use super::watch::ANSWERS_WITHIN;

/// Returns an `error/1` of something that did not move.
pub(crate) fn error_report(code: u8, kind: &str, message: &str) -> Value {
    report(code, kind, message, false)
}

/// Returns the `error/1` of a process that a signal has ended, so that it could not tell its own.
pub(super) fn killed(status: ExitStatus) -> Value {
    let message = format!(
        "the process of the order was killed ({status}), by a person or for lack of memory; the pump's record has the \
         bounds of what was delivered"
    );
    report(1, "killed", &message, true)
}

/// Returns the `error/1` of a process that the service has ended by a signal, since it did not answer a stop.
pub(super) fn ended_by_service() -> Value {
    let message = format!(
        "the service ended the process of the order, which had not answered the stop for {} s; the pump's record has \
         the bounds of what was delivered; look whether its motor stands",
        2 * ANSWERS_WITHIN.as_secs()
    );
    report(1, "killed", &message, true)
}

/// Returns the `error/1` of a process of whose motion nobody knows.
pub(crate) fn silent(message: &str) -> Value {
    report(1, "silent", message, true)
}

fn report(code: u8, kind: &str, message: &str, moved: bool) -> Value {
    json!({
        "schema": "error/1", "code": code, "kind": kind, "message": message, "value": null, "allowed": null,
        "moved": moved,
    })
}

/// Returns the words of an `error/1`.
pub(crate) fn message_of(report: &Value) -> &str {
    report.get("message").and_then(Value::as_str).unwrap_or("there is no reason on record")
}
