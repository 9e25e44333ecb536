//! The paths, and the checks that every request passes.

use std::sync::Arc;
use std::time::Duration;

use axum::extract::{DefaultBodyLimit, Request, State};
use axum::http::header::{CONTENT_TYPE, HeaderName};
use axum::http::{HeaderValue, Method, StatusCode};
use axum::middleware::{self, Next};
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use axum::{Json, Router};
use utoipa::OpenApi;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use super::api::{calibrations, inputs, log, orders, pumps, schedule};
use super::failure::Failure;
use super::shared::Shared;
use super::{assets, command, description, events, metrics};

/// Largest body of a request, in bytes.
const LARGEST_BODY: usize = 256 << 10;

/// Longest time that a request may take until its answer begins: a body may be sent too slowly.
const LONGEST_REQUEST: Duration = Duration::from_secs(30);

/// Description of the service for programs.
#[derive(OpenApi)]
#[openapi(
    info(title = "pump-dose", description = "Doses with the pumps of one machine. Volumes, rates and options are those \
        of the command `dose`, as texts with units. Errors are `error/1`; their `code` is the command's exit code."),
    tags((name = "pumps"), (name = "orders"), (name = "stop"), (name = "schedule"), (name = "guard"), (name = "events"))
)]
struct Description;

/// The paths that programs use, and their description.
fn described() -> (Router<Shared>, utoipa::openapi::OpenApi) {
    OpenApiRouter::with_openapi(Description::openapi())
        .routes(routes!(pumps::list))
        .routes(routes!(pumps::one))
        .routes(routes!(pumps::dose))
        .routes(routes!(pumps::prime))
        .routes(routes!(pumps::purge))
        .routes(routes!(pumps::run))
        .routes(routes!(pumps::resume))
        .routes(routes!(pumps::accept))
        .routes(routes!(pumps::stand))
        .routes(routes!(pumps::clear))
        .routes(routes!(pumps::emptied))
        .routes(routes!(pumps::calibrate))
        .routes(routes!(calibrations::list))
        .routes(routes!(calibrations::choose))
        .routes(routes!(pumps::stop))
        .routes(routes!(pumps::stop_all))
        .routes(routes!(pumps::racks))
        .routes(routes!(pumps::run_rack))
        .routes(routes!(orders::list))
        .routes(routes!(orders::one))
        .routes(routes!(orders::dose))
        .routes(routes!(orders::stop))
        .routes(routes!(orders::notes))
        .routes(routes!(log::log))
        .routes(routes!(schedule::schedule))
        .routes(routes!(schedule::add))
        .routes(routes!(schedule::change, schedule::remove))
        .routes(routes!(inputs::list))
        .routes(routes!(inputs::tell))
        .routes(routes!(events::events))
        .routes(routes!(metrics::metrics))
        .split_for_parts()
}

/// All paths, with the checks.
pub(super) fn router(shared: Shared) -> Router {
    let (programs, described) = described();
    let described = serde_json::to_value(described);
    let described = described.unwrap_or_else(|error| unreachable!("a description is JSON: {error}"));
    let described = Arc::new(description::completed(described));
    let guarded = programs
        .route("/openapi.json", get(move || async move { Json((*described).clone()) }))
        .route("/api/v1/command", post(command::command))
        .route("/api/v1/command/order", post(command::order))
        .route("/api/v1/command/status", post(command::status))
        .layer(middleware::from_fn_with_state(shared.clone(), needs_token));
    // A person who has not logged in yet sees the page, which asks for the token.
    let open = Router::new()
        .route("/", get(assets::page))
        .route("/app.js", get(assets::script))
        .route("/style.css", get(assets::style))
        .route("/icon.svg", get(assets::icon))
        .route("/login", get(assets::is_logged_in).post(assets::log_in))
        .route("/logout", post(assets::log_out));
    guarded
        .merge(open)
        .fallback(missing)
        .method_not_allowed_fallback(wrong_method)
        .layer(DefaultBodyLimit::max(LARGEST_BODY))
        .layer(middleware::from_fn_with_state(shared.clone(), checked))
        .with_state(shared)
}

/// Checks the host, the origin and the form of each request, bounds its time, and protects its answer.
async fn checked(State(shared): State<Shared>, request: Request, next: Next) -> Response {
    let mut response = match check(&shared, &request) {
        Err(failure) => failure.into_response(),
        Ok(()) => match tokio::time::timeout(LONGEST_REQUEST, next.run(request)).await {
            Ok(response) => response,
            Err(_) => {
                let message =
                    "the request took longer than 30 s; an order that it carried may have begun: ask for it";
                Failure::new(StatusCode::REQUEST_TIMEOUT, "time", message).into_response()
            }
        },
    };
    if response.status() == StatusCode::PAYLOAD_TOO_LARGE {
        let message = "the body is longer than 256 kB";
        response = Failure::new(StatusCode::PAYLOAD_TOO_LARGE, "usage", message).into_response();
    }
    let protected = [
        (
            "content-security-policy",
            "default-src 'self'; style-src 'self'; img-src 'self' data:; frame-ancestors 'none'; base-uri 'none'; \
             form-action 'self'",
        ),
        ("x-content-type-options", "nosniff"),
        ("referrer-policy", "no-referrer"),
        ("cache-control", "no-store"),
    ];
    for (name, value) in protected {
        let name = HeaderName::from_static(name);
        response.headers_mut().entry(name).or_insert(HeaderValue::from_static(value));
    }
    response
}

fn check(shared: &Shared, request: &Request) -> Result<(), Failure> {
    let headers = request.headers();
    shared.access.check_host(headers)?;
    shared.access.check_origin(request.method(), headers)?;
    let kind = headers.get(CONTENT_TYPE).and_then(|kind| kind.to_str().ok()).unwrap_or_default();
    let kind = kind.split(';').next().unwrap_or_default().trim();
    // A form of another site cannot send JSON without asking first.
    if [Method::POST, Method::PUT].contains(request.method())
        && !kind.eq_ignore_ascii_case("application/json")
    {
        let message =
            "a POST or a PUT needs the header `Content-Type: application/json`, also without a body";
        return Err(Failure::new(StatusCode::UNSUPPORTED_MEDIA_TYPE, "usage", message));
    }
    Ok(())
}

async fn needs_token(State(shared): State<Shared>, request: Request, next: Next) -> Response {
    match shared.access.check_token(request.headers(), shared.service.history()) {
        Ok(()) => next.run(request).await,
        Err(failure) => failure.into_response(),
    }
}

async fn missing(request: Request) -> Failure {
    Failure::missing("path", request.uri().path())
}

async fn wrong_method(request: Request) -> Failure {
    let message = format!("{} is no method of this path; /openapi.json lists them", request.method());
    Failure::new(StatusCode::METHOD_NOT_ALLOWED, "usage", message)
}
