//! The pumps, and the orders that they are given.

use axum::Json;
use axum::body::Bytes;
use axum::extract::{Path, State};
use axum::http::header::ORIGIN;
use axum::http::{HeaderMap, StatusCode};
use axum::response::{IntoResponse, Response};
use serde_json::{Value, json};

use super::super::bodies::{ClearBody, OptionsBody, ReadingBody, ReasonBody, VolumeBody, body};
use super::super::failure::Failure;
use super::super::shared::Shared;
use crate::history::{Key, OrderState};
use crate::order::{Options, Order, Origin, Task};
use crate::service::PumpView;
use crate::worker::Stop;

/// Description of the answer to a stop.
pub(super) const STOPPED: &str =
    "`asked`: the orders that were asked to stop; `stopped`: those of them that have ended within 1 s";

/// Header with the key of an order.
const KEY: &str = "idempotency-key";

/// Header of the answer to a key that was used before.
const REPEATED: &str = "idempotent-replayed";

/// The pumps of the configuration, with their records and what they do now.
#[utoipa::path(get, path = "/api/v1/pumps", tag = "pumps", responses(
    (status = 200, description = "A list of `pump-view/1`", body = Vec<Object>)))]
pub(in super::super) async fn list(State(shared): State<Shared>) -> Json<Vec<PumpView>> {
    let service = &shared.service;
    Json(service.pumps().map(|pump| service.view(pump)).collect())
}

/// One pump, with its record and what it does now.
#[utoipa::path(get, path = "/api/v1/pumps/{name}", tag = "pumps",
    params(("name" = String, Path, description = "Name of the pump in the configuration")),
    responses((status = 200, description = "`pump-view/1`", body = Object), (status = 404, description = "`error/1`")))]
pub(in super::super) async fn one(
    State(shared): State<Shared>,
    Path(name): Path<String>,
) -> Result<Json<PumpView>, Failure> {
    Ok(Json(shared.service.view(shared.service.pump(&name)?)))
}

/// Makes a dose, or several with the options `repeat` and `every`.
#[utoipa::path(post, path = "/api/v1/pumps/{name}/dose", tag = "orders", request_body = VolumeBody,
    params(("name" = String, Path, description = "Name of the pump in the configuration"),
        ("Idempotency-Key" = Option<String>, Header, description = "A key by which a repeated request doses once, \
         for 24 h and over restarts")),
    responses((status = 202, description = "`order/1`: the dose began, or was made", body = Object),
        (status = 409, description = "`error/1`: the pump is in use, or a dose is unfinished"),
        (status = 422, description = "`error/1`: refused before anything moved, or the key belongs to another order"),
        (status = 423, description = "`error/1`: the pump stands at a safety limit, or by order")))]
pub(in super::super) async fn dose(
    State(shared): State<Shared>,
    Path(name): Path<String>,
    headers: HeaderMap,
    bytes: Bytes,
) -> Result<Response, Failure> {
    let VolumeBody { volume, options } = body(&bytes)?;
    place(&shared, &name, Task::Dose { volume }, options, &headers).await
}

/// Fills the line; the carry stays as it is.
#[utoipa::path(post, path = "/api/v1/pumps/{name}/prime", tag = "orders", request_body = VolumeBody,
    params(("name" = String, Path, description = "Name of the pump in the configuration")),
    responses((status = 202, description = "`order/1`", body = Object), (status = 422, description = "`error/1`")))]
pub(in super::super) async fn prime(
    State(shared): State<Shared>,
    Path(name): Path<String>,
    headers: HeaderMap,
    bytes: Bytes,
) -> Result<Response, Failure> {
    let VolumeBody { volume, options } = body(&bytes)?;
    place(&shared, &name, Task::Prime { volume }, options, &headers).await
}

/// Empties the line; a negative volume runs back.
#[utoipa::path(post, path = "/api/v1/pumps/{name}/purge", tag = "orders", request_body = VolumeBody,
    params(("name" = String, Path, description = "Name of the pump in the configuration")),
    responses((status = 202, description = "`order/1`", body = Object), (status = 422, description = "`error/1`")))]
pub(in super::super) async fn purge(
    State(shared): State<Shared>,
    Path(name): Path<String>,
    headers: HeaderMap,
    bytes: Bytes,
) -> Result<Response, Failure> {
    let VolumeBody { volume, options } = body(&bytes)?;
    place(&shared, &name, Task::Purge { volume }, options, &headers).await
}

/// Runs at a rate for a time (`for`), for a volume, or until it is stopped.
#[utoipa::path(post, path = "/api/v1/pumps/{name}/run", tag = "orders", request_body = OptionsBody,
    params(("name" = String, Path, description = "Name of the pump in the configuration")),
    responses((status = 202, description = "`order/1`", body = Object), (status = 422, description = "`error/1`")))]
pub(in super::super) async fn run(
    State(shared): State<Shared>,
    Path(name): Path<String>,
    headers: HeaderMap,
    bytes: Bytes,
) -> Result<Response, Failure> {
    let OptionsBody { options } = body(&bytes)?;
    place(&shared, &name, Task::Run, options, &headers).await
}

/// Makes the rest of a dose that was stopped or cut off. The option `dose` names that dose; 409 if it is another one.
#[utoipa::path(post, path = "/api/v1/pumps/{name}/resume", tag = "orders", request_body = OptionsBody,
    params(("name" = String, Path, description = "Name of the pump in the configuration")),
    responses((status = 202, description = "`order/1`", body = Object), (status = 422, description = "`error/1`")))]
pub(in super::super) async fn resume(
    State(shared): State<Shared>,
    Path(name): Path<String>,
    headers: HeaderMap,
    bytes: Bytes,
) -> Result<Response, Failure> {
    let OptionsBody { options } = body(&bytes)?;
    place(&shared, &name, Task::Resume, options, &headers).await
}

/// Accepts a dose that was stopped or cut off as it is. The option `dose` names that dose; 409 if it is another one.
#[utoipa::path(post, path = "/api/v1/pumps/{name}/accept", tag = "orders", request_body = OptionsBody,
    params(("name" = String, Path, description = "Name of the pump in the configuration")),
    responses((status = 202, description = "`order/1`", body = Object),
        (status = 409, description = "`error/1`: another dose is unfinished than `dose`, or none (kind `changed`)"),
        (status = 422, description = "`error/1`")))]
pub(in super::super) async fn accept(
    State(shared): State<Shared>,
    Path(name): Path<String>,
    headers: HeaderMap,
    bytes: Bytes,
) -> Result<Response, Failure> {
    let OptionsBody { options } = body(&bytes)?;
    place(&shared, &name, Task::Accept, options, &headers).await
}

/// Puts a pump to stand until a person clears it, for a reason on record.
#[utoipa::path(post, path = "/api/v1/pumps/{name}/stand", tag = "orders", request_body = ReasonBody,
    params(("name" = String, Path, description = "Name of the pump in the configuration")),
    responses((status = 202, description = "`order/1`", body = Object),
        (status = 409, description = "`error/1`: the pump is in use; stop it first"),
        (status = 422, description = "`error/1`")))]
pub(in super::super) async fn stand(
    State(shared): State<Shared>,
    Path(name): Path<String>,
    headers: HeaderMap,
    bytes: Bytes,
) -> Result<Response, Failure> {
    let ReasonBody { reason } = body(&bytes)?;
    place(&shared, &name, Task::Stand { reason }, Options::new(), &headers).await
}

/// Clears a pump that stands, for a reason on record.
#[utoipa::path(post, path = "/api/v1/pumps/{name}/clear", tag = "orders", request_body = ClearBody,
    params(("name" = String, Path, description = "Name of the pump in the configuration")),
    responses((status = 202, description = "`order/1`", body = Object), (status = 422, description = "`error/1`")))]
pub(in super::super) async fn clear(
    State(shared): State<Shared>,
    Path(name): Path<String>,
    headers: HeaderMap,
    bytes: Bytes,
) -> Result<Response, Failure> {
    let ClearBody { reason, by } = body(&bytes)?;
    place(&shared, &name, Task::Clear { reason, by }, Options::new(), &headers).await
}

/// Says that the receiving vessel was emptied.
#[utoipa::path(post, path = "/api/v1/pumps/{name}/emptied", tag = "orders",
    params(("name" = String, Path, description = "Name of the pump in the configuration")),
    responses((status = 202, description = "`order/1`", body = Object), (status = 422, description = "`error/1`")))]
pub(in super::super) async fn emptied(
    State(shared): State<Shared>,
    Path(name): Path<String>,
    headers: HeaderMap,
) -> Result<Response, Failure> {
    place(&shared, &name, Task::Emptied, Options::new(), &headers).await
}

/// Calibrates by a reading of the last dose. The option `dose` names that dose; 409 if another one came since.
#[utoipa::path(post, path = "/api/v1/pumps/{name}/calibrate", tag = "orders", request_body = ReadingBody,
    params(("name" = String, Path, description = "Name of the pump in the configuration")),
    responses((status = 202, description = "`order/1`", body = Object),
        (status = 409, description = "`error/1`: another dose came since the one that was weighed"),
        (status = 422, description = "`error/1`")))]
pub(in super::super) async fn calibrate(
    State(shared): State<Shared>,
    Path(name): Path<String>,
    headers: HeaderMap,
    bytes: Bytes,
) -> Result<Response, Failure> {
    let ReadingBody { reading, options } = body(&bytes)?;
    place(&shared, &name, Task::Calibrate { reading }, options, &headers).await
}

/// Stops a pump: its motor decelerates and stands, and its volume is on record. A process that does not answer is
/// ended.
#[utoipa::path(post, path = "/api/v1/pumps/{name}/stop", tag = "stop",
    params(("name" = String, Path, description = "Name of the pump in the configuration")),
    responses((status = 200, description = STOPPED, body = Object), (status = 404, description = "`error/1`")))]
pub(in super::super) async fn stop(
    State(shared): State<Shared>,
    Path(name): Path<String>,
    headers: HeaderMap,
) -> Result<Json<Value>, Failure> {
    shared.service.pump(&name)?;
    let asked = shared.service.stop_by(Some(&name), &word("the service's stop", &headers));
    Ok(Json(shared.service.stopped(&asked).await))
}

/// Stops every pump.
#[utoipa::path(post, path = "/api/v1/stop", tag = "stop",
    responses((status = 200, description = STOPPED, body = Object)))]
pub(in super::super) async fn stop_all(State(shared): State<Shared>, headers: HeaderMap) -> Json<Value> {
    let asked = shared.service.stop_by(None, &word("the service's stop of all pumps", &headers));
    Json(shared.service.stopped(&asked).await)
}

/// Returns the word of a stop. A person at the page sees its end.
fn word(reason: &str, headers: &HeaderMap) -> Stop {
    Stop { reason: reason.to_owned(), is_seen: headers.contains_key(ORIGIN) }
}

/// Runs a rack of the configuration.
#[utoipa::path(post, path = "/api/v1/racks/{name}/run", tag = "orders", request_body = OptionsBody,
    params(("name" = String, Path, description = "Name of the rack in the configuration")),
    responses((status = 202, description = "`order/1`", body = Object), (status = 404, description = "`error/1`")))]
pub(in super::super) async fn run_rack(
    State(shared): State<Shared>,
    Path(rack): Path<String>,
    headers: HeaderMap,
    bytes: Bytes,
) -> Result<Response, Failure> {
    if !shared.service.config().racks().contains_key(&rack) {
        return Err(Failure::missing("rack", &rack));
    }
    let OptionsBody { options } = body(&bytes)?;
    place(&shared, "", Task::Rack { rack }, options, &headers).await
}

/// The racks of the configuration.
#[utoipa::path(get, path = "/api/v1/racks", tag = "pumps",
    responses((status = 200, description = "Names of the racks", body = Vec<String>)))]
pub(in super::super) async fn racks(State(shared): State<Shared>) -> Json<Vec<String>> {
    Json(shared.service.config().racks().keys().cloned().collect())
}

/// Gives an order, and answers with it as it stands: what was refused before anything moved is a refusal here too.
pub(super) async fn place(
    shared: &Shared,
    pump: &str,
    task: Task,
    options: Options,
    headers: &HeaderMap,
) -> Result<Response, Failure> {
    let order = Order { pump: pump.to_owned(), task, options };
    let key = match headers.get(KEY) {
        None => None,
        Some(text) => {
            let text = text.to_str().map_err(|_| {
                Failure::new(StatusCode::BAD_REQUEST, "key", "the header Idempotency-Key is no plain text")
            })?;
            let body = json!(order).to_string();
            Some(Key { text: text.to_owned(), body })
        }
    };
    // A browser says so with each order, and a page of another site was refused before.
    let origin = if headers.contains_key(ORIGIN) { Origin::Page } else { Origin::Http };
    let placed = shared.service.place(order, &origin, key).await?;
    if placed.record.state == OrderState::Refused {
        return Err(Failure::of_command(placed.record.code.unwrap_or(2), placed.record.error));
    }
    let location = format!("/api/v1/orders/{}", placed.record.id);
    let mut response = (StatusCode::ACCEPTED, [("location", location)], Json(placed.record)).into_response();
    if placed.repeated {
        response
            .headers_mut()
            .insert(REPEATED, "true".parse().unwrap_or_else(|_| unreachable!("plain text")));
    }
    Ok(response)
}
