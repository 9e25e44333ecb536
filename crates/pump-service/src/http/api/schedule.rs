//! The schedule of the service, and edits of its file.

use axum::Json;
use axum::body::Bytes;
use axum::extract::rejection::QueryRejection;
use axum::extract::{Path, Query, State};
use axum::http::header::{ETAG, IF_MATCH};
use axum::http::{HeaderMap, StatusCode};
use axum::response::{IntoResponse, Response};
use serde::Deserialize;
use serde_json::{Value, json};

use super::super::bodies::body;
use super::super::failure::Failure;
use super::super::shared::Shared;
use crate::runner::Edit;

/// How an edit is made.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(in super::super) struct How {
    /// True to check the entry, and to write nothing.
    #[serde(default, rename = "dry-run")]
    dry_run: bool,
}

/// The schedule that is in force, and the next time of each entry, with the doubt about it.
#[utoipa::path(get, path = "/api/v1/schedule", tag = "schedule",
    responses((status = 200, description = "`schedule/1` as JSON; in `next` for each entry its name, `at` \
        and `words` of its next time, its `zone`, and `doubt`: why its runs will be refused, or null; `error`: why \
        the file as it is now is not in force, or null; and the tag of the file, which the header `ETag` has too",
        body = Object)))]
pub(in super::super) async fn schedule(State(shared): State<Shared>) -> Response {
    match shared.schedule.as_ref() {
        Some(schedule) => tagged(StatusCode::OK, schedule.shown()),
        None => Json(json!({"schedule": null, "next": [], "file": null, "error": null})).into_response(),
    }
}

/// Adds an entry to the file of the schedule.
#[utoipa::path(post, path = "/api/v1/schedule/entries", tag = "schedule",
    request_body(content = Object, description = "Keys of the entry, as `schedule/1` has them"),
    params(("If-Match" = String, Header, description = "Tag of the schedule that was read"),
        ("dry-run" = Option<bool>, Query, description = "True to check the entry, and to write nothing")),
    responses((status = 201, description = "`schedule-edit/1`: the entry, its next runs, the new tag", body = Object),
        (status = 200, description = "The same for an entry that was only checked", body = Object),
        (status = 404, description = "`error/1`: the service has no schedule"),
        (status = 409, description = "`error/1`: the file has changed since it was read"),
        (status = 422, description = "`error/1` with the `key` that is wrong"),
        (status = 428, description = "`error/1`: the header If-Match is missing")))]
pub(in super::super) async fn add(
    State(shared): State<Shared>,
    how: Result<Query<How>, QueryRejection>,
    headers: HeaderMap,
    bytes: Bytes,
) -> Result<Response, Failure> {
    let Query(How { dry_run }) = how?;
    let done = if dry_run { StatusCode::OK } else { StatusCode::CREATED };
    edit(shared, Edit::Add(body(&bytes)?), &headers, dry_run, done).await
}

/// Changes an entry: those are all of its keys from now on.
#[utoipa::path(put, path = "/api/v1/schedule/entries/{name}", tag = "schedule",
    request_body(content = Object, description = "Keys of the entry, as `schedule/1` has them; `name` renames it"),
    params(("name" = String, Path, description = "Name of the entry"),
        ("If-Match" = String, Header, description = "Tag of the schedule that was read"),
        ("dry-run" = Option<bool>, Query, description = "True to check the entry, and to write nothing")),
    responses((status = 200, description = "`schedule-edit/1`: the entry, its next runs, the new tag", body = Object),
        (status = 404, description = "`error/1`: no such entry, or no schedule"),
        (status = 409, description = "`error/1`: the file has changed since it was read"),
        (status = 422, description = "`error/1` with the `key` that is wrong"),
        (status = 428, description = "`error/1`: the header If-Match is missing")))]
pub(in super::super) async fn change(
    State(shared): State<Shared>,
    Path(name): Path<String>,
    how: Result<Query<How>, QueryRejection>,
    headers: HeaderMap,
    bytes: Bytes,
) -> Result<Response, Failure> {
    let Query(How { dry_run }) = how?;
    edit(shared, Edit::Change(name, body(&bytes)?), &headers, dry_run, StatusCode::OK).await
}

/// Takes an entry out of the file of the schedule, with the comment above it.
#[utoipa::path(delete, path = "/api/v1/schedule/entries/{name}", tag = "schedule",
    params(("name" = String, Path, description = "Name of the entry"),
        ("If-Match" = String, Header, description = "Tag of the schedule that was read")),
    responses((status = 200, description = "`schedule-edit/1` with the new tag", body = Object),
        (status = 404, description = "`error/1`: no such entry, or no schedule"),
        (status = 409, description = "`error/1`: the file has changed since it was read"),
        (status = 428, description = "`error/1`: the header If-Match is missing")))]
pub(in super::super) async fn remove(
    State(shared): State<Shared>,
    Path(name): Path<String>,
    headers: HeaderMap,
) -> Result<Response, Failure> {
    edit(shared, Edit::Remove(name), &headers, false, StatusCode::OK).await
}

/// Edits the file where it may wait for the disk.
async fn edit(
    shared: Shared,
    edit: Edit,
    headers: &HeaderMap,
    dry: bool,
    done: StatusCode,
) -> Result<Response, Failure> {
    let Some(schedule) = shared.schedule else {
        let message =
            "the service has no schedule; name its file as `schedule` in `[service]` of the configuration";
        return Err(Failure::new(StatusCode::NOT_FOUND, "missing", message));
    };
    let Some(tag) = headers.get(IF_MATCH).and_then(|tag| tag.to_str().ok()) else {
        let message = "an edit needs the header If-Match with the ETag of the schedule that was read";
        return Err(Failure::new(StatusCode::PRECONDITION_REQUIRED, "usage", message));
    };
    let tag = tag.trim().trim_start_matches("W/").trim_matches('"').to_owned();
    let edited = tokio::task::spawn_blocking(move || schedule.edit(&edit, &tag, dry)).await;
    let edited = edited.map_err(|error| Failure::new(StatusCode::INTERNAL_SERVER_ERROR, "service", error))?;
    Ok(tagged(done, edited?))
}

/// An answer with the tag of the file in its head.
fn tagged(status: StatusCode, told: Value) -> Response {
    let tag = format!("\"{}\"", told["etag"].as_str().unwrap_or_default());
    (status, [(ETAG, tag)], Json(told)).into_response()
}
