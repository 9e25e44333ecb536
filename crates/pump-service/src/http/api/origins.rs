//! Those who ordered the doses of a log, beside each of its lines.

use std::sync::Arc;

use axum::body::Bytes;
use serde::Deserialize;

use crate::history::History;
use crate::worker::LogFormat;

/// Puts `origin` to each line of a log that passes in pieces: the service alone knows who gave an order.
#[derive(Debug)]
pub(super) struct Origins {
    history: Arc<History>,
    format: LogFormat,
    /// Begin of a line whose end has not come yet.
    rest: Vec<u8>,
    /// True once the heads of the table have passed.
    has_heads: bool,
}

/// The order of a line.
#[derive(Deserialize)]
struct Ordered {
    schema: String,
    order: Option<String>,
}

impl Origins {
    pub(super) fn new(history: Arc<History>, format: LogFormat) -> Self {
        Self { history, format, rest: Vec::new(), has_heads: false }
    }

    /// Returns the lines that end in a piece, or the rest without one.
    pub(super) fn put(&mut self, piece: Option<Bytes>) -> Bytes {
        if self.format == LogFormat::Text {
            return piece.unwrap_or_default();
        }
        let Some(piece) = piece else { return Bytes::from(std::mem::take(&mut self.rest)) };
        self.rest.extend_from_slice(&piece);
        let end = self.rest.iter().rposition(|byte| *byte == b'\n').map_or(0, |at| at + 1);
        let after = self.rest.split_off(end);
        let whole = std::mem::replace(&mut self.rest, after);
        let lines = String::from_utf8_lossy(&whole);
        lines.lines().map(|line| self.with_origin(line) + "\n").collect::<String>().into()
    }

    fn with_origin(&mut self, line: &str) -> String {
        let of = |order: &str| self.history.origin(order).ok().flatten();
        if self.format == LogFormat::Csv {
            let is_heads = !std::mem::replace(&mut self.has_heads, true);
            let order = line.rsplit(',').next().unwrap_or_default();
            let origin = if is_heads { "origin".to_owned() } else { of(order).unwrap_or_default() };
            return format!("{line},{origin}");
        }
        let ordered = serde_json::from_str::<Ordered>(line).ok().filter(|line| line.schema == "log/1");
        match (ordered, line.strip_suffix('}')) {
            (Some(Ordered { order, .. }), Some(open)) => {
                let origin = order.and_then(|order| of(&order));
                format!("{open},\"origin\":{}}}", serde_json::Value::from(origin))
            }
            _ => line.to_owned(),
        }
    }
}
