//! The places of stops: where all others are taken, a stop is answered still.

use std::collections::VecDeque;

use axum::http::Method;
use tokio::task::AbortHandle;

/// Connections at a time that may yet ask for a stop.
const MOST: usize = 64;

/// Connections beyond the bound, the oldest first. Each may ask for a stop, and nothing else.
#[derive(Debug, Default)]
pub(super) struct Reserve(VecDeque<AbortHandle>);

impl Reserve {
    /// Takes a connection in. Where there are too many, the oldest one ends: a stop takes milliseconds, so that one is
    /// slow.
    pub(super) fn take(&mut self, connection: AbortHandle) {
        self.0.retain(|connection| !connection.is_finished());
        while self.0.len() >= MOST {
            self.0.pop_front().iter().for_each(AbortHandle::abort);
        }
        self.0.push_back(connection);
    }
}

/// Returns true for a request that stops a pump, an order or all.
pub(super) fn is_stop(method: &Method, path: &str) -> bool {
    let below = path.strip_prefix("/api/v1/").unwrap_or_default();
    let is_it =
        matches!(below.split('/').collect::<Vec<_>>()[..], ["stop"] | ["pumps" | "orders", _, "stop"]);
    method == Method::POST && is_it
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stop_is_one_of_a_pump_of_an_order_or_of_all() {
        for path in ["/api/v1/stop", "/api/v1/pumps/acid/stop", "/api/v1/orders/0123/stop"] {
            assert!(is_stop(&Method::POST, path), "{path}");
            assert!(!is_stop(&Method::GET, path), "{path}");
        }
        for path in ["/", "/stop", "/api/v1/stop/", "/api/v1/pumps/acid/dose", "/api/v1/pumps/acid/dose/stop"]
        {
            assert!(!is_stop(&Method::POST, path), "{path}");
        }
    }
}
