//! The schedule of the service.

use axum::Json;
use axum::extract::State;
use serde_json::{Value, json};

use super::super::shared::Shared;

/// The schedule that is in force, and the next time of each entry, with the doubt about it.
#[utoipa::path(get, path = "/api/v1/schedule", tag = "schedule",
    responses((status = 200, description = "`schedule/1` as JSON; in `next` for each entry its name, `at` \
        and `words` of its next time, and `doubt`: why its runs will be refused, or null", body = Object)))]
pub(in super::super) async fn schedule(State(shared): State<Shared>) -> Json<Value> {
    Json(match shared.schedule.as_ref() {
        Some(schedule) => schedule.shown(),
        None => json!({"schedule": null, "next": [], "file": null}),
    })
}
