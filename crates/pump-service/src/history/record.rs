//! Rows of the history.

use jiff::Timestamp;
use serde::Serialize;
use serde_json::Value;

use crate::order::{Order, OrderId};

/// Key by which a program may repeat an order that it does not know the fate of.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Key {
    /// Text of the key, as the program gave it.
    pub text: String,
    /// Order that the key stands for, as one line of JSON.
    pub body: String,
}

/// State of an order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum OrderState {
    /// The order is carried out.
    Running,
    /// The order was carried out.
    Done,
    /// The order was refused before anything moved.
    Refused,
    /// The order failed or was stopped after it began.
    Failed,
    /// The service ended before the order did. The pump's journal has what was delivered.
    CutOff,
}

impl OrderState {
    /// Words of the states in the file.
    const WORDS: [(Self, &'static str); 5] = [
        (Self::Running, "running"),
        (Self::Done, "done"),
        (Self::Refused, "refused"),
        (Self::Failed, "failed"),
        (Self::CutOff, "cut-off"),
    ];

    /// Returns the word of the state.
    pub fn word(self) -> &'static str {
        Self::WORDS.iter().find(|(state, _)| *state == self).map_or("", |(_, word)| word)
    }

    /// Finds the state of a word. A word that nobody knows is that of an order whose end nobody knows.
    pub(super) fn of_word(word: &str) -> Self {
        Self::WORDS.iter().find(|(_, known)| *known == word).map_or(Self::CutOff, |(state, _)| *state)
    }

    /// Returns the state of an order that ended with this exit code and this `error/1`.
    pub fn ended(code: i32, error: Option<&Value>) -> Self {
        let moved = error.and_then(|error| error.get("moved")).and_then(Value::as_bool);
        match (code, moved) {
            (0, _) => Self::Done,
            // These codes say that nothing moved, also in words for people.
            (2..=4, _) | (_, Some(false)) => Self::Refused,
            _ => Self::Failed,
        }
    }
}

/// An order on record, `order/1`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OrderRecord {
    /// `order/1`.
    pub schema: &'static str,
    /// Name of the order.
    pub id: OrderId,
    /// The order itself.
    #[serde(flatten)]
    pub order: Order,
    /// Giver of the order.
    pub origin: String,
    /// State of the order.
    pub state: OrderState,
    /// Time at which the order was given.
    pub begun: Timestamp,
    /// Time at which the order ended; null while it runs.
    pub ended: Option<Timestamp>,
    /// Exit code of its command; null while it runs.
    pub code: Option<i32>,
    /// Reports of its command, as `dose/1`; of a batch the last 1000. While it runs, the plan of the present motion is
    /// the last. Lists and events have the last one alone.
    pub reports: Vec<Value>,
    /// Messages of its command for people.
    pub messages: Vec<String>,
    /// Reason of a failure, `error/1`.
    pub error: Option<Value>,
}

impl OrderRecord {
    /// An order that begins now.
    pub(crate) fn begun(id: OrderId, order: Order, origin: String, begun: Timestamp) -> Self {
        let (schema, state) = ("order/1", OrderState::Running);
        let (ended, code, error) = (None, None, None);
        let (reports, messages) = (Vec::new(), Vec::new());
        Self { schema, id, order, origin, state, begun, ended, code, reports, messages, error }
    }

    /// Returns the order with its last report alone: a batch has thousands.
    #[must_use]
    pub fn brief(mut self) -> Self {
        self.reports = self.reports.pop().into_iter().collect();
        self
    }
}

/// An event of the service on record.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EventRecord {
    /// Time of the event.
    pub time: Timestamp,
    /// Kind of the event, as `schedule`, `guard` or `service`.
    pub kind: String,
    /// Name of the pump, if it is one pump's event.
    pub pump: Option<String>,
    /// The event in words.
    pub text: String,
}
