//! The inputs of the guard.

use axum::Json;
use axum::body::Bytes;
use axum::extract::{Path, State};

use super::super::bodies::body;
use super::super::failure::Failure;
use super::super::shared::Shared;
use crate::guard::{InputView, Said};

/// The inputs that must be alive, with what they said last.
#[utoipa::path(get, path = "/api/v1/inputs", tag = "guard",
    responses((status = 200, description = "A list of `input/1`", body = Vec<InputView>)))]
pub(in super::super) async fn list(State(shared): State<Shared>) -> Json<Vec<InputView>> {
    Json(shared.guard.inputs())
}

/// Tells whether an input is well. If it is not, its pumps stop and stand until a person clears them.
#[utoipa::path(post, path = "/api/v1/inputs/{name}", tag = "guard", request_body = Said,
    params(("name" = String, Path, description = "Name of the input in the configuration")),
    responses((status = 200, description = "`input/1` as it is now", body = InputView),
        (status = 404, description = "`error/1`"),
        (status = 422, description = "`error/1`: the body is wrong, or the input's command or topic speaks for it")))]
pub(in super::super) async fn tell(
    State(shared): State<Shared>,
    Path(name): Path<String>,
    bytes: Bytes,
) -> Result<Json<InputView>, Failure> {
    let Said { ok, reason } = body(&bytes)?;
    Ok(Json(shared.guard.tell(&name, ok, reason.as_deref())?))
}
