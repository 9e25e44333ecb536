//! Refusals over HTTP: `error/1` with a status.

use axum::extract::rejection::QueryRejection;
use axum::http::StatusCode;
use axum::http::header::CONTENT_TYPE;
use axum::response::{IntoResponse, Response};
use pump_bench::report::ErrorKind;
use serde_json::Value;

use crate::guard::GuardError;
use crate::runner::EditError;
use crate::service::Refusal;
use crate::service::error_report;

/// Refusal of a request: its status and its `error/1`.
#[derive(Debug)]
pub(super) struct Failure {
    status: StatusCode,
    report: Value,
}

impl Failure {
    /// A refusal in words.
    pub(super) fn new(status: StatusCode, kind: &str, message: impl ToString) -> Self {
        Self { status, report: error_report(2, kind, &message.to_string()) }
    }

    /// The `error/1` of a command that refused before anything moved.
    pub(super) fn of_command(code: i32, error: Option<Value>) -> Self {
        let kind = error.as_ref().and_then(|error| error.get("kind")?.as_str());
        let status = match code {
            _ if kind == Some(ErrorKind::Changed.as_str()) => StatusCode::CONFLICT,
            3 | 4 => StatusCode::CONFLICT,
            5 => StatusCode::LOCKED,
            _ => StatusCode::UNPROCESSABLE_ENTITY,
        };
        let report =
            error.unwrap_or_else(|| error_report(2, "command", "the command was refused without a reason"));
        Self { status, report }
    }

    /// Something that does not exist.
    pub(super) fn missing(what: &str, name: &str) -> Self {
        let name: String = name.chars().take(80).collect();
        Self::new(StatusCode::NOT_FOUND, "missing", format!("there is no {what} `{}`", name.escape_debug()))
    }
}

impl From<Refusal> for Failure {
    fn from(refusal: Refusal) -> Self {
        let status = match &refusal {
            Refusal::UnknownPump { .. } => StatusCode::NOT_FOUND,
            Refusal::Busy { .. } => StatusCode::CONFLICT,
            Refusal::Guarded { .. } | Refusal::NotWell { .. } => StatusCode::LOCKED,
            Refusal::Order(_) | Refusal::KeyReused { .. } => StatusCode::UNPROCESSABLE_ENTITY,
            Refusal::Key(_) => StatusCode::BAD_REQUEST,
            Refusal::Ending => StatusCode::SERVICE_UNAVAILABLE,
            Refusal::History(_) | Refusal::Start(_) | Refusal::Random(_) => StatusCode::INTERNAL_SERVER_ERROR,
        };
        Self { status, report: refusal.report() }
    }
}

impl From<QueryRejection> for Failure {
    fn from(rejection: QueryRejection) -> Self {
        // The parser's own words name the key and what it allows; their first part says that it is a query.
        let text = rejection.body_text();
        let why = text.split_once(": ").map_or(text.as_str(), |(_, why)| why);
        Self::new(StatusCode::UNPROCESSABLE_ENTITY, "usage", format!("the query: {why}"))
    }
}

impl From<GuardError> for Failure {
    fn from(error: GuardError) -> Self {
        match &error {
            GuardError::UnknownInput { .. } => Self::new(StatusCode::NOT_FOUND, "missing", error),
            GuardError::OfCommand(_) | GuardError::OfTopic(_) => {
                Self::new(StatusCode::UNPROCESSABLE_ENTITY, "usage", error)
            }
        }
    }
}

impl From<EditError> for Failure {
    fn from(error: EditError) -> Self {
        let (status, kind) = match &error {
            EditError::Missing(_) => (StatusCode::NOT_FOUND, "missing"),
            EditError::Changed | EditError::Unusable(_) => (StatusCode::CONFLICT, "changed"),
            EditError::Write(_) | EditError::History(_) | EditError::Syntax(_) => {
                (StatusCode::INTERNAL_SERVER_ERROR, "output")
            }
            _ => (StatusCode::UNPROCESSABLE_ENTITY, "schedule"),
        };
        let mut failure = Self::new(status, kind, &error);
        failure.report["key"] = error.key().into();
        if let EditError::Refused(refused) = &error {
            failure.report["value"] = refused.value().into();
            failure.report["allowed"] = refused.allowed().into();
        }
        failure
    }
}

impl IntoResponse for Failure {
    fn into_response(self) -> Response {
        let headers = [(CONTENT_TYPE, "application/json")];
        (self.status, headers, self.report.to_string()).into_response()
    }
}
