//! The log of a pump, as `dose log` tells it.

use axum::body::Body;
use axum::extract::rejection::QueryRejection;
use axum::extract::{Path, Query, State};
use axum::http::StatusCode;
use axum::http::header::{CONTENT_DISPOSITION, CONTENT_TYPE};
use axum::response::{IntoResponse, Response};
use serde::Deserialize;
use tokio_stream::StreamExt;
use tokio_stream::wrappers::ReceiverStream;

use super::super::failure::Failure;
use super::super::shared::Shared;
use super::origins::Origins;
use crate::worker::{LogFormat, log_words, output};

/// Part of the log.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(in super::super) struct Part {
    since: Option<String>,
    until: Option<String>,
    format: Option<LogFormat>,
}

/// Every dose of a pump with its time, and the totals by day and tube.
#[utoipa::path(get, path = "/api/v1/pumps/{name}/log", tag = "pumps",
    params(("name" = String, Path, description = "Name of the pump in the configuration"),
        ("since" = Option<String>, Query, description = "First time, as `2d` or `2026-03-01`"),
        ("until" = Option<String>, Query, description = "Last time"),
        ("format" = Option<String>, Query, description = "`json` (a `log/1` a line), `csv` or `text`")),
    responses((status = 200, description = "The log", content_type = "application/x-ndjson"),
        (status = 404, description = "`error/1`"), (status = 422, description = "`error/1`")))]
pub(in super::super) async fn log(
    State(shared): State<Shared>,
    Path(name): Path<String>,
    part: Result<Query<Part>, QueryRejection>,
) -> Result<Response, Failure> {
    let Query(part) = part?;
    let pump = shared.service.pump(&name)?.name().to_owned();
    let format = part.format.unwrap_or(LogFormat::Json);
    let words = log_words(&pump, part.since.as_deref(), part.until.as_deref(), format);
    let words = words.map_err(crate::service::Refusal::from)?;
    let started = output(shared.service.program(), &words).await;
    let started =
        started.map_err(|error| Failure::new(StatusCode::INTERNAL_SERVER_ERROR, "service", error))?;
    let lines = started.map_err(|ended| Failure::of_command(ended.code, ended.error))?;
    let (kind, ending) = match format {
        LogFormat::Json => ("application/x-ndjson", "jsonl"),
        LogFormat::Csv => ("text/csv; charset=utf-8", "csv"),
        LogFormat::Text => ("text/plain; charset=utf-8", "txt"),
    };
    let named = format!("inline; filename=\"{pump}.{ending}\"");
    let origins = Origins::new(shared.service.history().clone(), &pump, format);
    let mut origins = origins.map_err(crate::service::Refusal::from)?;
    let told = ReceiverStream::new(lines).map(Some).chain(tokio_stream::once(None));
    let body = Body::from_stream(told.map(move |piece| Ok::<_, std::io::Error>(origins.put(piece))));
    Ok(([(CONTENT_TYPE, kind.to_owned()), (CONTENT_DISPOSITION, named)], body).into_response())
}
