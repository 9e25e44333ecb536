//! Orders by their names.

use axum::Json;
use axum::body::Bytes;
use axum::extract::rejection::QueryRejection;
use axum::extract::{Path, Query, State};
use axum::http::StatusCode;
use serde::Deserialize;
use serde_json::{Value, json};

use super::super::bodies::{StopBody, body};
use super::super::failure::Failure;
use super::super::shared::Shared;
use super::pumps::STOPPED;
use crate::history::{EventRecord, OrderRecord, OrderState};
use crate::order::OrderId;
use crate::service::Refusal;

/// Most rows of a list.
const MOST: u32 = 1000;

/// Reason of a stop that gives none, as the log keeps it.
const STOP: &str = "the service's stop";

/// Longest reason, in letters.
const MOST_REASON: usize = 100;

/// Rows of a list without a number.
const USUAL: u32 = 50;

/// Part of a list.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(in super::super) struct Part {
    /// Name of the pump whose rows are wanted.
    pump: Option<String>,
    /// Most rows.
    limit: Option<u32>,
}

/// The last orders, the latest first.
#[utoipa::path(get, path = "/api/v1/orders", tag = "orders",
    params(("pump" = Option<String>, Query, description = "Name of a pump"),
        ("limit" = Option<u32>, Query, description = "Most rows, 50 without it, 1000 at most")),
    responses((status = 200, description = "A list of `order/1`", body = Vec<Object>)))]
pub(in super::super) async fn list(
    State(shared): State<Shared>,
    part: Result<Query<Part>, QueryRejection>,
) -> Result<Json<Vec<OrderRecord>>, Failure> {
    let Query(part) = part?;
    let most = part.limit.unwrap_or(USUAL).min(MOST);
    let history = shared.service.history();
    let orders = history.last_orders(part.pump.as_deref(), most).map_err(Refusal::from)?;
    Ok(Json(orders.into_iter().map(OrderRecord::brief).collect()))
}

/// One order as it stands.
#[utoipa::path(get, path = "/api/v1/orders/{id}", tag = "orders",
    params(("id" = String, Path, description = "Name of the order")),
    responses((status = 200, description = "`order/1`", body = Object), (status = 404, description = "`error/1`")))]
pub(in super::super) async fn one(
    State(shared): State<Shared>,
    Path(id): Path<String>,
) -> Result<Json<OrderRecord>, Failure> {
    Ok(Json(find(&shared, &id)?))
}

/// The report of a dose: its plan while it runs, and then its last report. An order that was cut off before its report
/// has the bounds of its volume by the pump's record, `dose-bounds/1`.
#[utoipa::path(get, path = "/api/v1/doses/{id}", tag = "orders",
    params(("id" = String, Path, description = "Name of the order")),
    responses((status = 200, description = "`dose/1`; of an order that was cut off `dose-bounds/1`, with \
            `delivered_least_ml`, `delivered_most_ml` and `numbers`, those of the log", body = Object),
        (status = 404, description = "`error/1`"),
        (status = 409, description = "`error/1`: the order has no report of a dose, or none yet")))]
pub(in super::super) async fn dose(
    State(shared): State<Shared>,
    Path(id): Path<String>,
) -> Result<Json<Value>, Failure> {
    let mut record = find(&shared, &id)?;
    let is_dose = |report: &Value| report.get("schema").and_then(Value::as_str) == Some("dose/1");
    match record.reports.pop().filter(is_dose) {
        Some(report) => Ok(Json(report)),
        None if is_left(&record) => bounds(&shared, &record).map(Json),
        None => {
            let message = format!("order {id} ({}) has no report of a dose", record.order.task.name());
            Err(Failure::new(StatusCode::CONFLICT, "missing", message))
        }
    }
}

/// Returns true for an order that may have moved its pump and ended before its report.
fn is_left(record: &OrderRecord) -> bool {
    let has_ended = matches!(record.state, OrderState::CutOff | OrderState::Failed);
    has_ended && record.order.task.moves() && !record.order.pump.is_empty()
}

/// Returns what the pump's record knows of an order without a report.
fn bounds(shared: &Shared, record: &OrderRecord) -> Result<Value, Failure> {
    let pump = shared.service.pump(&record.order.pump)?;
    let Some(((least_ml, most_ml), numbers)) = pump.bench().delivered_by(record.id.as_str()) else {
        let message = format!("the record of pump {} cannot be read", pump.name());
        return Err(Failure::new(StatusCode::INTERNAL_SERVER_ERROR, "record", message));
    };
    Ok(json!({
        "schema": "dose-bounds/1", "order": record.id, "pump": pump.name(), "state": record.state, "completed": false,
        "delivered_least_ml": least_ml, "delivered_most_ml": most_ml, "numbers": numbers,
    }))
}

/// Stops one order.
#[utoipa::path(post, path = "/api/v1/orders/{id}/stop", tag = "stop", request_body = StopBody,
    params(("id" = String, Path, description = "Name of the order")),
    responses((status = 200, description = STOPPED, body = Object),
        (status = 404, description = "`error/1`")))]
pub(in super::super) async fn stop(
    State(shared): State<Shared>,
    Path(id): Path<String>,
    bytes: Bytes,
) -> Result<Json<Value>, Failure> {
    let StopBody { reason } = body(&bytes)?;
    let record = find(&shared, &id)?;
    let reason: String = reason.unwrap_or_else(|| STOP.to_owned()).chars().take(MOST_REASON).collect();
    let asked = shared.service.stop_order(&record.id, &reason);
    Ok(Json(shared.service.stopped(asked.then_some(record.id).as_slice()).await))
}

/// Notes of what a person should know, the latest first.
#[utoipa::path(get, path = "/api/v1/notes", tag = "orders",
    params(("limit" = Option<u32>, Query, description = "Most rows, 50 without it, 1000 at most")),
    responses((status = 200, description = "Notes with time, kind, pump and text", body = Vec<Object>)))]
pub(in super::super) async fn notes(
    State(shared): State<Shared>,
    part: Result<Query<Part>, QueryRejection>,
) -> Result<Json<Vec<EventRecord>>, Failure> {
    let Query(part) = part?;
    let most = part.limit.unwrap_or(USUAL).min(MOST);
    Ok(Json(shared.service.history().last_events(most).map_err(Refusal::from)?))
}

fn find(shared: &Shared, id: &str) -> Result<OrderRecord, Failure> {
    let found = shared.service.order(&OrderId::of(id))?;
    found.ok_or_else(|| Failure::missing("order", id))
}
