//! The calibrations of a pump, and the one in use.

use axum::body::Bytes;
use axum::extract::{Path, State};
use axum::http::StatusCode;
use axum::http::header::{CONTENT_TYPE, HeaderMap};
use axum::response::{IntoResponse, Response};
use pump_bench::report::{calibrations_json, with_sources};

use super::super::bodies::{CalibrationBody, body};
use super::super::failure::Failure;
use super::super::shared::Shared;
use super::pumps::place;
use crate::order::{Options, Task};

/// Every calibration of a pump, and the number of the one in use.
#[utoipa::path(get, path = "/api/v1/pumps/{name}/calibrations", tag = "pumps",
    params(("name" = String, Path, description = "Name of the pump in the configuration")),
    responses((status = 200, description = "`calibrations/1`: `active`, null for none, and the list `calibrations`",
            body = Object),
        (status = 404, description = "`error/1`")))]
pub(in super::super) async fn list(
    State(shared): State<Shared>,
    Path(name): Path<String>,
) -> Result<Response, Failure> {
    let calibrations = shared.service.pump(&name)?.bench().calibrations();
    let read = calibrations.list().and_then(|all| Ok((all, calibrations.active_version()?)));
    let (all, active) = read.map_err(|error| {
        Failure::new(StatusCode::INTERNAL_SERVER_ERROR, "calibration", with_sources(&error))
    })?;
    Ok(([(CONTENT_TYPE, "application/json")], calibrations_json(&all, active)).into_response())
}

/// Has doses use another calibration, or none, from now on.
#[utoipa::path(post, path = "/api/v1/pumps/{name}/calibrate/use", tag = "orders", request_body = CalibrationBody,
    params(("name" = String, Path, description = "Name of the pump in the configuration")),
    responses((status = 202, description = "`order/1`", body = Object), (status = 422, description = "`error/1`")))]
pub(in super::super) async fn choose(
    State(shared): State<Shared>,
    Path(name): Path<String>,
    headers: HeaderMap,
    bytes: Bytes,
) -> Result<Response, Failure> {
    let CalibrationBody { calibration } = body(&bytes)?;
    place(&shared, &name, Task::UseCalibration { calibration }, Options::new(), &headers).await
}
