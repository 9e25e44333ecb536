//! Those who ordered the doses of a log, and what became of each dose after its end, beside each of its lines.

use std::collections::BTreeMap;
use std::sync::Arc;

use axum::body::Bytes;
use serde::Deserialize;
use serde_json::Value;

use crate::history::{History, HistoryError, Marks};
use crate::worker::LogFormat;

/// Puts `origin`, `weighed` and `accepted` to each line of a log that passes in pieces: the service alone knows who
/// gave an order.
#[derive(Debug)]
pub(super) struct Origins {
    history: Arc<History>,
    format: LogFormat,
    /// Doses that were weighed for a calibration, or accepted.
    marks: BTreeMap<u64, Marks>,
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
    number: Option<u64>,
}

impl Origins {
    /// Reads the marks of a pump.
    pub(super) fn new(history: Arc<History>, pump: &str, format: LogFormat) -> Result<Self, HistoryError> {
        let marks = history.marks(pump)?;
        Ok(Self { history, format, marks, rest: Vec::new(), has_heads: false })
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
            if !std::mem::replace(&mut self.has_heads, true) {
                return format!("{line},origin,weighed,accepted");
            }
            let order = line.rsplit(',').next().unwrap_or_default();
            let number = line.split(',').next().and_then(|number| number.parse().ok());
            let Marks { weighed, accepted } = self.marks_of(number);
            let origin = of(order).unwrap_or_default();
            return format!("{line},{origin},{weighed},{}", accepted.unwrap_or_default());
        }
        let ordered = serde_json::from_str::<Ordered>(line).ok().filter(|line| line.schema == "log/1");
        match (ordered, line.strip_suffix('}')) {
            (Some(Ordered { order, number, .. }), Some(open)) => {
                let Marks { weighed, accepted } = self.marks_of(number);
                let [origin, accepted] = [order.and_then(|order| of(&order)), accepted].map(Value::from);
                format!("{open},\"origin\":{origin},\"weighed\":{weighed},\"accepted\":{accepted}}}")
            }
            _ => line.to_owned(),
        }
    }

    fn marks_of(&self, number: Option<u64>) -> Marks {
        number.and_then(|number| self.marks.get(&number)).cloned().unwrap_or_default()
    }
}
