//! The page: one document, one style sheet, one script and a picture, which are part of the program.

use std::time::Duration;

use axum::Json;
use axum::body::Bytes;
use axum::extract::State;
use axum::http::header::{CONTENT_TYPE, HeaderMap, SET_COOKIE};
use axum::http::{HeaderName, StatusCode};
use axum::response::IntoResponse;
use serde::Deserialize;
use serde_json::{Value, json};

use super::bodies::body;
use super::failure::Failure;
use super::session::{HOLDS, SESSION_COOKIE};
use super::shared::Shared;
use crate::service::Refusal;

/// Time that a login with a wrong token takes, so that nobody tries many.
const WRONG_TAKES: Duration = Duration::from_secs(1);

/// An answer of a text of this kind.
type Asset = ([(HeaderName, &'static str); 1], &'static str);

pub(super) async fn page() -> Asset {
    ([(CONTENT_TYPE, "text/html; charset=utf-8")], include_str!("../page/index.html"))
}

pub(super) async fn script() -> Asset {
    ([(CONTENT_TYPE, "text/javascript; charset=utf-8")], include_str!("../page/app.js"))
}

pub(super) async fn style() -> Asset {
    ([(CONTENT_TYPE, "text/css; charset=utf-8")], include_str!("../page/style.css"))
}

pub(super) async fn icon() -> Asset {
    ([(CONTENT_TYPE, "image/svg+xml")], include_str!("../page/icon.svg"))
}

/// The token of a login.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct LoginBody {
    token: String,
}

/// Tells whether a login is needed, and whether there is one.
pub(super) async fn is_logged_in(State(shared): State<Shared>, headers: HeaderMap) -> Json<Value> {
    let needed = shared.access.needs_login();
    let may = !needed || shared.access.check_token(&headers, shared.service.history()).is_ok();
    Json(json!({"needed": needed, "may": may}))
}

/// Begins a login, whose cookie no other site can use.
pub(super) async fn log_in(State(shared): State<Shared>, bytes: Bytes) -> Result<impl IntoResponse, Failure> {
    let LoginBody { token } = body(&bytes)?;
    let Some(session) = shared.access.log_in(token.trim(), shared.service.history())? else {
        tokio::time::sleep(WRONG_TAKES).await;
        let message = "this is not the service's token; it is in the file that the service was started with";
        return Err(Failure::new(StatusCode::UNAUTHORIZED, "token", message));
    };
    let seconds = HOLDS.as_secs();
    let cookie = format!("{SESSION_COOKIE}={session}; Path=/; HttpOnly; SameSite=Strict; Max-Age={seconds}");
    Ok(([(SET_COOKIE, cookie)], Json(json!({"needed": true, "may": true}))))
}

/// Ends every login.
pub(super) async fn log_out(
    State(shared): State<Shared>,
    headers: HeaderMap,
) -> Result<impl IntoResponse, Failure> {
    shared.access.check_token(&headers, shared.service.history())?;
    shared.service.history().end_logins().map_err(Refusal::from)?;
    let cookie = format!("{SESSION_COOKIE}=; Path=/; HttpOnly; SameSite=Strict; Max-Age=0");
    Ok(([(SET_COOKIE, cookie)], Json(json!({"needed": true, "may": false}))))
}
