//! The connections: how many, how slow, and until when.

use std::convert::Infallible;
use std::future::Future;
use std::sync::Arc;
use std::time::Duration;

use axum::body::Body;
use axum::extract::Request;
use axum::http::StatusCode;
use axum::http::header::CONNECTION;
use axum::response::{IntoResponse, Response};
use hyper::body::Incoming;
use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper_util::rt::{TokioIo, TokioTimer};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::Semaphore;
use tower::ServiceExt;

use super::access::Access;
use super::failure::Failure;
use super::reserve::{Reserve, is_stop};
use super::router::router;
use super::shared::Shared;
use crate::guard::Guard;
use crate::runner::Runner;
use crate::service::Service;

/// Pause after a connection could not be taken, as where no file descriptor is left.
const PAUSE: Duration = Duration::from_millis(50);

/// Longest time of a connection above the bound: it asks for a stop, or is told that there is no place.
const LAST_WORD: Duration = Duration::from_secs(1);

/// Bounds of the connections.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Most connections at a time. Further ones may stop pumps, and are told otherwise that the service is busy.
    pub connections: usize,
    /// Longest time that the head of a request may take, and that a connection may rest between two.
    pub head: Duration,
}

impl Default for Limits {
    fn default() -> Self {
        Self { connections: 256, head: Duration::from_secs(10) }
    }
}

/// Answers requests until `until` is done.
pub async fn serve(
    listener: TcpListener,
    service: Service,
    access: Access,
    schedule: Option<Arc<Runner>>,
    guard: Guard,
    limits: Limits,
    until: impl Future<Output = ()>,
) {
    let version = env!("CARGO_PKG_VERSION");
    let router = router(Shared { service, access: Arc::new(access), schedule, guard, version });
    let places = Arc::new(Semaphore::new(limits.connections));
    let mut reserve = Reserve::default();
    tokio::pin!(until);
    loop {
        let taken = tokio::select! {
            () = &mut until => return,
            taken = listener.accept() => taken,
        };
        let Ok((stream, _)) = taken else {
            tokio::time::sleep(PAUSE).await;
            continue;
        };
        // A click shall not wait for a packet to fill.
        let _ = stream.set_nodelay(true);
        match Arc::clone(&places).try_acquire_owned() {
            Ok(place) => {
                let router = router.clone();
                tokio::spawn(async move {
                    answer(stream, limits.head, move |request: Request<Incoming>| {
                        let router = router.clone();
                        async move { router.oneshot(request.map(Body::new)).await }
                    })
                    .await;
                    drop(place);
                });
            }
            Err(_) => {
                let router = router.clone();
                let to = move |request: Request<Incoming>| {
                    let stop = is_stop(request.method(), request.uri().path()).then(|| router.clone());
                    async move {
                        let Some(router) = stop else { return Ok(last(full())) };
                        router.oneshot(request.map(Body::new)).await.map(last)
                    }
                };
                let answered = tokio::time::timeout(LAST_WORD, answer(stream, LAST_WORD, to));
                reserve.take(tokio::spawn(answered).abort_handle());
            }
        }
    }
}

/// Answers the requests of one connection.
async fn answer<F, R>(stream: TcpStream, head: Duration, to: F)
where
    F: Fn(Request<Incoming>) -> R,
    R: Future<Output = Result<Response, Infallible>>,
{
    let connection = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(head)
        .serve_connection(TokioIo::new(stream), service_fn(to));
    // A peer that goes away or breaks the protocol has no one to tell.
    let _ = connection.await;
}

fn full() -> Response {
    let message = "the service has as many connections as it takes; close some, or try again";
    Failure::new(StatusCode::SERVICE_UNAVAILABLE, "busy", message).into_response()
}

/// Makes an answer the last one of its connection.
fn last(mut response: Response) -> Response {
    response.headers_mut().insert(CONNECTION, "close".parse().unwrap_or_else(|_| unreachable!("plain text")));
    response
}
