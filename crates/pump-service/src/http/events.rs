//! The events of the service, as server-sent events.

use std::convert::Infallible;
use std::time::Duration;

use axum::extract::State;
use axum::response::Sse;
use axum::response::sse::{Event as SseEvent, KeepAlive};
use serde_json::json;
use tokio::sync::broadcast::error::RecvError;
use tokio::sync::mpsc::channel;
use tokio_stream::Stream;
use tokio_stream::wrappers::ReceiverStream;

use super::shared::Shared;
use crate::guard::Guard;
use crate::service::Service;

/// Time between two signs of life.
const ALIVE: Duration = Duration::from_secs(2);

/// Events that wait for a slow watcher. One that is slower is told everything anew.
const WAITING: usize = 64;

/// Events from now on: first `hello` with the state of every pump and of every input, then `pump`, `progress`, `order`,
/// `input` and `note`, and `alive` after each 2 s without another.
/// A watcher that was too slow gets `hello` again.
#[utoipa::path(get, path = "/events", tag = "events",
    responses((status = 200, description = "Server-sent events", content_type = "text/event-stream")))]
pub(super) async fn events(
    State(shared): State<Shared>,
) -> Sse<impl Stream<Item = Result<SseEvent, Infallible>>> {
    let (give, take) = channel(WAITING);
    let Shared { service, guard, version, .. } = shared;
    tokio::spawn(async move {
        let mut watch = service.watch();
        if give.send(Ok(hello(&service, &guard, version))).await.is_err() {
            return;
        }
        loop {
            let event = tokio::select! {
                () = give.closed() => return,
                event = watch.recv() => event,
            };
            let event = match event {
                Ok(event) => SseEvent::default().event(event.name).data(&*event.data),
                Err(RecvError::Lagged(_)) => hello(&service, &guard, version),
                Err(RecvError::Closed) => return,
            };
            if give.send(Ok(event)).await.is_err() {
                return;
            }
        }
    });
    Sse::new(ReceiverStream::new(take))
        .keep_alive(KeepAlive::new().interval(ALIVE).event(SseEvent::default().event("alive").data("")))
}

/// The state of every pump and of every input, for a watcher that knows nothing.
fn hello(service: &Service, guard: &Guard, version: &str) -> SseEvent {
    let pumps: Vec<_> = service.pumps().map(|pump| service.view(pump)).collect();
    let racks: Vec<&String> = service.config().racks().keys().collect();
    let data = json!({"version": version, "pumps": pumps, "racks": racks, "inputs": guard.inputs()});
    SseEvent::default().event("hello").data(data.to_string())
}
