//! The events that a service tells its watchers.

use std::sync::Arc;

use serde::Serialize;

/// Event of a service: a name, and data as one line of JSON.
///
/// - `pump`: a pump's state has changed; the data is its [`PumpView`](super::PumpView).
/// - `progress`: a motion goes on, `progress/1` with the pump's name and the order.
/// - `order`: an order began or ended, `order/1`.
/// - `input`: an input of the guard says something else than before, or has spoken again, `input/1`.
/// - `note`: something happened that a person should know, with `time`, `kind`, `pump` and `text`.
#[derive(Debug, Clone)]
pub struct Event {
    /// Name of the event.
    pub name: &'static str,
    /// Data as one line of JSON.
    pub data: Arc<str>,
}

impl Event {
    /// Makes an event of plain data.
    pub(crate) fn new(name: &'static str, data: &impl Serialize) -> Self {
        let data = serde_json::to_string(data).unwrap_or_else(|error| unreachable!("plain data: {error}"));
        Self { name, data: data.into() }
    }
}
